"""The one training loop of all networks, the examples it draws, and the weights it keeps.

A new optimiser, schedule or kind of checkpoint goes here; every network is trained by `loop`.
"""

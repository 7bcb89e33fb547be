"""The one training loop, the networks it trains, the examples it draws, the weights it keeps.

A new optimiser, schedule or kind of checkpoint goes here; every network is trained by `loop`.
"""

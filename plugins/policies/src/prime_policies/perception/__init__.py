"""The perception ``pose-network``: a network tells object poses from images.

Another perception gets a folder of its own beside this one; settings load no torch.
"""

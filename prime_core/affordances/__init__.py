"""Where primitives go: gripper poses as parameters, and draws of them around affordances.

What packs of primitives share. A rule of how affordances are drawn from goes here.
"""

"""Where primitives go: gripper poses as parameters, draws of them, how objects lie then.

What packs of primitives share. A rule of how affordances are drawn from goes here.
"""

"""The policy over primitives ``prime``: its settings, and the policy at work.

Another policy over primitives gets a folder of its own beside this one.
"""

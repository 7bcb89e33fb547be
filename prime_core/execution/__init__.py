"""Runs primitives and policies in an environment, step by step: trials and replays.

Whatever steps an environment uses the loops of `motions`.
"""

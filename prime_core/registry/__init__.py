"""What plugins register: kinds of things, their names, how they are found and built.

A new kind is a line in `kinds` and a hook in `prime_core.hookspecs`.
"""

"""Cuts demonstrations into segments by the scores of an inverse dynamics model.

A new parser is a file here, registered in `prime_core.registry.builtin`.
"""

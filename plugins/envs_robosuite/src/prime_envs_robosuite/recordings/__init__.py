"""Demonstrations that were recorded elsewhere, in formats of robosuite.

Another format is a file with a ``DemonstratorConfig``, registered in the package's ``__init__``.
"""

"""Experiments: their YAML, their stages, and what runs them.

A new key of the YAML starts in `settings`.
"""

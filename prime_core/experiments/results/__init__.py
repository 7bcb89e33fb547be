"""Gathers the results of an experiment, and shows them as tables.

A new figure starts in `summaries`; `figures` says how it is shown.
"""

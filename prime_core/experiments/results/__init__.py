"""Gathers the results of an experiment, and shows them as tables and figures.

A new figure of a table starts in `summaries`; `figures` says how it is shown. `chart` draws several
experiments as one picture.
"""

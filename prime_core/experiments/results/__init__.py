"""What comes out of an experiment: gathered results, as tables and figures; policies, exported.

A new figure of a table starts in `summaries`; `figures` says how it is shown. `chart` draws several
experiments as one picture.
"""

"""What comes out of an experiment: gathered results, shown as tables; policies, exported.

A new figure starts in `summaries`; `figures` says how it is shown.
"""

"""What leaves a run for a robot or another machine: a folder of models, and what runs them.

Nothing here builds an environment or knows of stages. Another thing that a folder must hold is
described in `manifest`, written by `write` and loaded by `exported_models`.
"""

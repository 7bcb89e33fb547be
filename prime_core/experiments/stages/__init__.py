"""The stages of an experiment, each cached by exca under what it depends on.

A new stage is a file here and a line in `prime_core.experiments.experiment`.
"""

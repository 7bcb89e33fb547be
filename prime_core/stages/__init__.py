"""The stages of an experiment, each cached by exca under what it depends on."""

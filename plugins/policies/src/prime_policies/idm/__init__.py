"""The inverse dynamics model ``mlp-gmm``: its settings, and the model at work.

Another inverse dynamics model gets a folder of its own beside this one.
"""

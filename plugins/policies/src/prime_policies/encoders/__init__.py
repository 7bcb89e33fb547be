"""Encoders of images: settings, networks, the crops that they are given.

A new encoder has its settings in `config` and its network in a module of its own, which the
settings import when they build it: importing settings loads no torch.
"""

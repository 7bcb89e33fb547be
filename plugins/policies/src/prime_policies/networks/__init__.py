"""Networks of object poses and robot state: a classifier, and mixtures of parameters.

A new network is a module here; what it learns from and how it is trained is in `training`.
"""

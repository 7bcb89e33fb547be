"""Networks of object poses and robot state: what they see, a classifier, mixtures of parameters.

A new network is a module here; what it learns from and how it is trained is in `training`.
"""

"""What plugins implement and exchange: environments, scenes, primitives, models, policies.

A new kind of thing that plugins may register has its contract here.
"""

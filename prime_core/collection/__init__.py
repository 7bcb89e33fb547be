"""Self-supervised collection of rollouts (paper, Alg. 1), and the table that is learnt from.

A new way to explore is another method of the collector in `episode`.
"""

"""Policies over motor actions: ``bc-rnn``, its settings, its network, and the policy at work.

What such policies share is apart from the network: windows of episodes (`windows`), the ranges of
what is seen and done (`scaling`), and how a network is trained on them (`fitting`). Another policy
over motor actions has its settings in `config` and its network in a module of its own; LeRobot's
have a folder of their own, `prime_policies.lerobot`.
"""

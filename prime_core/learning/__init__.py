"""Makes training data of rollouts and parsed demonstrations; tests models on held-out rollouts.

Networks live in plugins; what they learn from is made here, and so is the card that says what
trained weights are for.
"""

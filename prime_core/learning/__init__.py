"""Makes training data of rollouts and parsed demonstrations; tests models on held-out rollouts.

Networks live in plugins. What any of them needs that is no network lives here: what they learn
from, the features that they see, and the card that says what trained weights are for.
"""

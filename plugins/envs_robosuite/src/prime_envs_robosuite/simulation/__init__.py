"""The physics of robosuite's Panda: models, the compiled control law, states and resets.

Nothing here knows a task. Another way to step is a `Stepper` in ``stepping.py``.
"""

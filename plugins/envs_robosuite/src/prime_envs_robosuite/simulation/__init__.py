"""The physics of robosuite's Panda: models, the compiled control law, states, resets, pictures.

Nothing here knows a task. Another way to step is a `Stepper` in ``stepping.py``; names of
cameras stand in ``rendering.py``.
"""

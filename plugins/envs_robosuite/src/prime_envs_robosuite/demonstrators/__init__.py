"""The simulated teleoperator, who does a task's subtasks without knowing any primitive.

Another way of moving is another entry in ``styles.py``; another kind of subtask gets a file like
``pushing.py`` and a line in ``teleoperator.py``.
"""

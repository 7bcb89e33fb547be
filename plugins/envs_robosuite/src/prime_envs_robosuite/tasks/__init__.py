"""The tasks: what is on the table, what is to be done with it, and when it is solved.

A new task is a file with a subclass of `Task`; its robosuite environment goes to
``robosuite_models.py`` and ``robosuite_import.py``, its settings to ``../config.py``. On a table
with boxes, bins and mats it is a `TableTopTask` with a layout, and needs no class of robosuite.
"""

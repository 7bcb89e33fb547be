"""Tasks that are read from robosuite's models, whatever they are.

`RobosuiteTask` takes any task for one arm by its robosuite name. A task of its own here is a
subclass with affordances and subtasks that no model tells, as `StackTask` is.
"""

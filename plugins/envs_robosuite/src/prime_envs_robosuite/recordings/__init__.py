"""Demonstrations in formats of robosuite and robomimic: read, and written for them.

Another format is a file with a ``DemonstratorConfig`` or an ``ExporterConfig``, registered in the
package's ``__init__``.
"""

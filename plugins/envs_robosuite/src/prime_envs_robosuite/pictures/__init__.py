"""Pictures of a scene, off screen: cameras, the OpenGL context, and meshes that are fast to draw.

Names of cameras and how finely things are drawn stand in ``cameras.py``, what is decimated and how
far in ``light_meshes.py``.
"""

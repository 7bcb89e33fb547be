"""Segments written into data sets that are there already; all else in them stays as it is.

What else an annotation is to write goes into `data_files`, if each frame has it, or `metadata`.
"""

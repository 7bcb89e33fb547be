"""Demonstrations become data sets, or files of other programs, outside of an experiment.

Another format to convert to is another file here, beside ``convert``.
"""

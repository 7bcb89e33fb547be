"""Recordings become data sets, outside of an experiment.

Another format to convert to is another file here, beside ``convert``.
"""

"""Recordings become data sets, outside of an experiment: `prime convert`.

What a conversion can be asked for is in ``asked``, how it is done in ``convert``.
"""

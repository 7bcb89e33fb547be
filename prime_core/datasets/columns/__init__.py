"""Which columns of a data set from elsewhere hold what, and in which units.

A new unit or way to write an orientation is a word in `settings` and a line in `conversion`.
"""

"""Demonstrations as LeRobot v3 data sets: reading, writing, and a demonstrator that shows them.

A new column of our data sets starts in `files/layout.py`. `images` has how images are kept,
`columns` which columns of others hold what, `annotation` what writes segments into a data set.
"""

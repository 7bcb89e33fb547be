"""Demonstrations as LeRobot v3 data sets: reading, writing, and a demonstrator that shows them.

A new column of our data sets starts in `layout`.
"""

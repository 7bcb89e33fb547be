"""The files of a LeRobot v3 data set: what they are called, their header, tables and statistics.

What LeRobot's next version calls otherwise changes here.
"""

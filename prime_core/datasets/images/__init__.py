"""Images of demonstrations: as PNG files inside a data set, as its videos, as a stage's own files.

Another way that a data set keeps images is another file here.
"""

"""Pictures and videos of plain data; knows no experiment.

A new picture is a file here that takes its looks from `style`, and those of methods from `methods`.
"""

"""The stages that make what people look at: data sets, timelines and videos; no stage needs them.

Something else to look at is another stage here.
"""

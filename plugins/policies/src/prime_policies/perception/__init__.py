"""Models of images: where things are, told from images, for the networks that see object poses.

Another way to see is a module here, beside `perception`; settings load no torch.
"""

"""What lets the folder of a run tell the truth: digests, marks of code, repairs, locks.

A new kind of damage is mended in `cache`; new trouble with disks is told in `place`.
"""

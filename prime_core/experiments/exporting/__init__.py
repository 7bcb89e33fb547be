"""What leaves a run: its demonstrations for other programs, its policies for other machines.

Another thing that users take out of a run is another file here.
"""

"""Where a parser finds the grasps of recorded demonstrations, and where they really are.

Really, something is grasped at the frame from which the gripper holds the object for at least
half a second. Prints a markdown table.

    python benchmarks/human_grasps.py runs/lift/dataset [FOLDER ...]
"""

import sys
from pathlib import Path

import numpy as np

from prime_core.contracts.demonstration import Demonstration, Segment
from prime_core.datasets.read import read_dataset

LASTING = 10  # frames
EARLY = 20  # frames by which a segment may end before the real grasp: a second
STAYING = 0.02  # [m] that the gripper may have moved since, at a segment's end


def grasp_frames(shown: Demonstration) -> list[int]:
    """Return the frames from which an object is held for a while."""
    held = shown.observations.held.any(axis=1)
    begins = np.flatnonzero(held & ~np.append(False, held[:-1]))
    return [int(frame) for frame in begins if held[frame : frame + LASTING].all()]


def is_around(segment: Segment, frame: int, shown: Demonstration) -> bool:
    """Whether a segment starts before a grasp, and ends with the gripper still there."""
    moved = (
        shown.observations.gripper_position[segment.end]
        - shown.observations.gripper_position[frame]
    )
    ends_there = segment.end >= frame - EARLY and np.linalg.norm(moved) < STAYING
    return bool(segment.start < frame and ends_there)


def main(folders: list[str]) -> None:
    print("| data set | demonstration | frames | held from | grasp segments | around a real one |")
    print("|---|---|---|---|---|---|")
    found = total = 0
    for folder in folders:
        dataset = read_dataset(Path(folder))
        if dataset.segments is None:
            raise SystemExit(f"{folder} is not parsed")
        pairs = zip(dataset.demonstrations, dataset.segments, strict=True)
        for number, (shown, segments) in enumerate(pairs):
            frames = grasp_frames(shown)
            grasps = [item for item in segments if item.call.primitive == "grasp"]
            around = any(is_around(item, frame, shown) for item in grasps for frame in frames)
            found, total = found + around, total + 1
            spans = ", ".join(f"{item.start}-{item.end}" for item in grasps)
            real = ", ".join(map(str, frames))
            answer = "yes" if around else "no"
            print(
                f"| {folder} | {number} | {len(shown.observations)} | {real} | {spans} | {answer} |"
            )
    print(f"\n{found} of {total} have a grasp segment that starts before a real grasp, and ends")
    print(f"at most {EARLY} frames before it or later, with the gripper within {STAYING} m of it.")


if __name__ == "__main__":
    if not sys.argv[1:]:
        raise SystemExit(__doc__)
    main(sys.argv[1:])

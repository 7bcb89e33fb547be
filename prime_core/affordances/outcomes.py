"""How objects lie after a motion: what success of a place or a push is judged by."""

from collections.abc import Sequence

import numpy as np

from prime_core.contracts.scene import Scene

STILL = 0.001  # [m] a step, 20 mm/s: what falls or slides is faster


def lies_still(scenes: Sequence[Scene], index: int) -> bool:
    """Whether an object did not move in the last step.

    Args:
        scenes: Two at least.
        index: Row of the object.
    """
    before, after = (scene.object_positions[index] for scene in scenes[-2:])
    return float(np.linalg.norm(after - before)) < STILL


def is_put_down(
    scenes: Sequence[Scene], release: Scene, index: int, greatest_slide: float, greatest_fall: float
) -> bool:
    """Whether an object lies still, about where it was let go of.

    Args:
        scenes: Of the motion, two at least.
        release: Where it was let go of.
        index: Row of the object.
        greatest_slide: How far it may have come to lie from there in the plane [m].
        greatest_fall: How far below [m].
    """
    moved = scenes[-1].object_positions[index] - release.object_positions[index]
    near = float(np.hypot(moved[0], moved[1])) < greatest_slide
    return near and float(-moved[2]) < greatest_fall and lies_still(scenes, index)

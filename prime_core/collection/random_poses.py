"""Object poses at random: what a perception is to tell, but random rollouts hardly ever show.

Rollouts that knock things over fail, and are not kept. A policy's do happen: who has seen upright
things only takes one that has fallen for something else, somewhere else.
"""

from dataclasses import replace

import numpy as np

from prime_core.arrays import Array
from prime_core.contracts.observations import OBJECT_WIDTH, Observations
from prime_core.rotations import quaternion_product

ELSEWHERE_SHARE = 0.5  # of frames: where the thing is in another frame; else near where it is
NEAR = 0.04  # standard deviation of the plane's coordinates there [m]
HEIGHTS = (-0.03, 0.02)  # what is added to the height [m]: a thing's middle is lower as it lies
UPRIGHT_SHARE, LYING_SHARE = 0.3, 0.4  # of frames; in the others it has any tilt
LYING = 0.15  # standard deviation about a quarter turn [rad]


def with_random_poses(seen: Observations, generator: np.random.Generator) -> Observations:
    """Return instants with object poses drawn at random, but for those of objects that are held.

    No physics is asked: things may hang in the air, or stand into one another.

    Args:
        seen: With object poses; images are left out.
        generator: Of all draws.
    """
    poses = np.array(seen.environment_state).reshape(len(seen), -1, OBJECT_WIDTH)
    for index in range(poses.shape[1]):
        free = np.flatnonzero(~seen.held[:, index])
        places = poses[free, index, :3]
        poses[free, index, :3] = _places(places, generator)
        poses[free, index, 3:7] = _turns(len(free), generator)
    return replace(seen, environment_state=poses.reshape(len(seen), -1), images={})


def _places(places: Array, generator: np.random.Generator) -> Array:
    near = places.copy()
    near[:, :2] += generator.normal(0.0, NEAR, (len(places), 2))
    elsewhere = places[generator.permutation(len(places))]
    chosen = generator.random((len(places), 1)) < ELSEWHERE_SHARE
    result: Array = np.where(chosen, elsewhere, near)
    result[:, 2] += generator.uniform(*HEIGHTS, len(places))
    return result


def _turns(count: int, generator: np.random.Generator) -> Array:
    """Draw a yaw, then a tilt about any axis of the plane, ``(count, 4)``."""
    shares = generator.random(count)
    lying = np.pi / 2 + generator.normal(0.0, LYING, count)
    tilt = np.where(shares < UPRIGHT_SHARE + LYING_SHARE, lying, generator.uniform(0, np.pi, count))
    tilt[shares < UPRIGHT_SHARE] = 0.0
    axis, yaw = generator.uniform(-np.pi, np.pi, (2, count))
    tilts, yaws = np.zeros((2, count, 4))
    tilts[:, 0], yaws[:, 0] = np.cos(tilt / 2), np.cos(yaw / 2)
    tilts[:, 1], tilts[:, 2] = np.sin(tilt / 2) * np.cos(axis), np.sin(tilt / 2) * np.sin(axis)
    yaws[:, 3] = np.sin(yaw / 2)
    return quaternion_product(tilts, yaws)

"""Where primitives make sense: draws of parameters around the centres of affordances."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from prime_core.primitive_calls import ParameterSpace
from prime_core.rotations import wrap_angle, yaw_of
from prime_core.scene import Affordance, Scene
from prime_primitives_scripted.goal import JAW_PERIOD

Array = NDArray[np.float64]

REDRAWS = 20
OUTSIDE = 0.02  # [m] that a centre may lie outside of the bounds


def draw(
    scene: Scene,
    affordances: Sequence[Affordance],
    space: ParameterSpace,
    std: tuple[float, float, float, float],
    generator: np.random.Generator,
) -> Array:
    """Draw x, y, z and yaw near the centre of one of the affordances.

    Args:
        scene: Gives the poses of the objects that affordances go with.
        affordances: Each is as likely as another; those outside of the bounds are left out.
            Without any, the draw is uniform within the bounds.
        space: Bounds of x, y, z [m] and yaw [rad].
        std: Standard deviations about the centre [m, m, m, rad].
        generator: Where the draw comes from.

    Returns:
        ``(4,)``, within the bounds.
    """
    usable = [item for item in affordances if _overlaps(scene, item, space)]
    if not usable:
        return space.sample(generator)
    affordance = usable[int(generator.integers(len(usable)))]
    centre = np.append(
        draw_centre(scene, affordance, generator), draw_yaw(scene, affordance, generator)
    )
    values = centre
    # Clipping alone would heap draws up on the bounds where the spread is wide.
    for _ in range(REDRAWS):
        values = centre + generator.normal(0.0, std)
        values[3] = wrap_angle(values[3], JAW_PERIOD)
        if space.contains(values):
            return values
    return np.clip(values, space.low, space.high)


def draw_centre(scene: Scene, affordance: Affordance, generator: np.random.Generator) -> Array:
    """Draw a centre uniformly in an affordance's box.

    Returns:
        Position [m], world frame, ``(3,)``.
    """
    return _in_world(scene, affordance, generator.uniform(affordance.low, affordance.high))


def draw_yaw(scene: Scene, affordance: Affordance, generator: np.random.Generator) -> float:
    """Draw a yaw of the jaws that suits an affordance.

    Of the yaws that the object's symmetry makes equal, the one with the shortest turn from
    the gripper's present yaw is taken.

    Returns:
        Yaw [rad], in ``[-pi / 2, pi / 2)``.
    """
    if affordance.yaws is None:
        return float(generator.uniform(-JAW_PERIOD / 2, JAW_PERIOD / 2))
    yaw = affordance.yaws[int(generator.integers(len(affordance.yaws)))]
    period = JAW_PERIOD
    if affordance.reference is not None:
        index = scene.object_index(affordance.reference)
        yaw += float(yaw_of(scene.object_quaternions[index]))
        period = _jaw_symmetry(scene.description.objects[index].yaw_symmetry)
        if period == 0.0:  # a round object: the yaw as it is
            yaw, period = scene.gripper_yaw, JAW_PERIOD
    turn = wrap_angle(yaw - scene.gripper_yaw, period)
    return float(wrap_angle(scene.gripper_yaw + turn, JAW_PERIOD))


def _jaw_symmetry(yaw_symmetry: int) -> float:
    """Return the least turn that changes neither an object nor the jaws; 0 if round."""
    if yaw_symmetry == 0:
        return 0.0
    # n-fold for the object and two-fold for the jaws: together lcm(n, 2)-fold.
    return 2 * np.pi / float(np.lcm(yaw_symmetry, 2))


def _in_world(scene: Scene, affordance: Affordance, point: Array) -> Array:
    """Return the world position of a point in an affordance's frame, ``(3,)``."""
    if affordance.reference is None:
        return point
    index = scene.object_index(affordance.reference)
    yaw = float(yaw_of(scene.object_quaternions[index]))
    cosine, sine = np.cos(yaw), np.sin(yaw)
    turned = [cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1], point[2]]
    return np.asarray(scene.object_positions[index] + turned, dtype=np.float64)


def _overlaps(scene: Scene, affordance: Affordance, space: ParameterSpace) -> bool:
    """Whether the middle of an affordance is within the bounds, or nearly."""
    middle = (np.asarray(affordance.low) + np.asarray(affordance.high)) / 2
    centre = _in_world(scene, affordance, middle)
    low, high = space.low[:3] - OUTSIDE, space.high[:3] + OUTSIDE
    return bool(np.all(centre >= low) and np.all(centre <= high))

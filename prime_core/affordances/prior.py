"""Where primitives make sense: draws of parameters around the centres of affordances."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from prime_core.affordances.goals import JAW_PERIOD
from prime_core.contracts.calls import ParameterSpace
from prime_core.contracts.description import Affordance
from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle, yaw_of

Array = NDArray[np.float64]

REDRAWS = 20
OUTSIDE = 0.02  # [m] that a centre may lie outside of the bounds
# Of what is held [rad]. The parameters name the jaws' yaw, to which motions take the shorter
# turn: beyond a quarter turn, less what draws spread, it would end up turned the other way.
GREATEST_TURN = JAW_PERIOD / 2 - 0.2


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
        affordances: Each is as likely as another; those of the gripper outside of the bounds
            are left out, and those of what is held if nothing is, or if none of their yaws can be
            turned to. Without any, the draw is uniform within the bounds.
        space: Bounds of x, y, z [m] and yaw [rad].
        std: Standard deviations about the centre [m, m, m, rad].
        generator: Where the draw comes from.

    Returns:
        ``(4,)``, within the bounds.
    """
    usable = [item for item in affordances if _is_usable(scene, item, space)]
    if not usable:
        return space.sample(generator)
    affordance = usable[int(generator.integers(len(usable)))]
    if affordance.of_held:
        centre = _draw_for_held(scene, affordance, space, generator)
    else:
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
        yaw += _yaw_of_object(scene, affordance.reference)
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
    centre = scene.object_positions[scene.object_index(affordance.reference)]
    turned = _turned(point, _yaw_of_object(scene, affordance.reference))
    return np.asarray(centre + turned, dtype=np.float64)


def _draw_for_held(
    scene: Scene, affordance: Affordance, space: ParameterSpace, generator: np.random.Generator
) -> Array:
    """Draw where the gripper has to go for what it holds to be where an affordance says.

    What is held turns with the gripper; the box says where its own centre goes.

    Args:
        scene: Gives the pose of what is held relative to the gripper.
        affordance: Of what is held.
        space: Bounds of the gripper's x, y, z [m] and yaw [rad].
        generator: Where the draw comes from.

    Returns:
        x, y, z [m] and yaw [rad] of the gripper, ``(4,)``; within the bounds if one of some
        draws is.
    """
    assert scene.held is not None, "an affordance of what is held is usable with something held"
    away = scene.gripper_position - scene.object_positions[scene.object_index(scene.held)]
    turns = _turns_of_held(scene, affordance)
    values: Array = np.zeros(4)
    for _ in range(REDRAWS):
        if turns is None:
            turn = float(generator.uniform(-GREATEST_TURN, GREATEST_TURN))
        else:
            turn = turns[int(generator.integers(len(turns)))]
        position = draw_centre(scene, affordance, generator) + _turned(away, turn)
        values = np.append(position, wrap_angle(scene.gripper_yaw + turn, JAW_PERIOD))
        if space.contains(values):
            break
    return values


def _turns_of_held(scene: Scene, affordance: Affordance) -> list[float] | None:
    """Return the turns of what is held that end at a good yaw [rad]; None if any is good."""
    if affordance.yaws is None:
        return None
    assert scene.held is not None, "an affordance of what is held is usable with something held"
    yaw = _yaw_of_object(scene, scene.held)
    base = 0.0 if affordance.reference is None else _yaw_of_object(scene, affordance.reference)
    turns = [float(wrap_angle(base + item - yaw)) for item in affordance.yaws]
    return [turn for turn in turns if abs(turn) <= GREATEST_TURN]


def _yaw_of_object(scene: Scene, name: str) -> float:
    return float(yaw_of(scene.object_quaternions[scene.object_index(name)]))


def _turned(point: Array, yaw: float) -> Array:
    """Return a point [m] ``(3,)`` turned about z."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    x, y, z = point
    return np.array([cosine * x - sine * y, sine * x + cosine * y, z])


def _is_usable(scene: Scene, affordance: Affordance, space: ParameterSpace) -> bool:
    """Whether an affordance makes sense now and its middle is within the bounds, or nearly."""
    if affordance.of_held:
        return scene.held is not None and _turns_of_held(scene, affordance) != []
    middle = (np.asarray(affordance.low) + np.asarray(affordance.high)) / 2
    centre = _in_world(scene, affordance, middle)
    low, high = space.low[:3] - OUTSIDE, space.high[:3] + OUTSIDE
    return bool(np.all(centre >= low) and np.all(centre <= high))

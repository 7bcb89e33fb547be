"""Phases of motion: generators that are composed with ``yield from``.

A phase yields motor actions, is sent the scene after each, and returns the last scene.
"""

from collections.abc import Callable, Generator

import numpy as np
from numpy.typing import NDArray

from prime_core.affordances.goals import (
    distance,
    gripper_goal,
    jaw_distance,
    plane_distance,
)
from prime_core.contracts.environment import Action
from prime_core.contracts.scene import Scene
from prime_primitives_scripted.mover import Mover

Array = NDArray[np.float64]
Phase = Generator[Action, Scene, Scene]

WAYPOINT_DISTANCE = 0.02  # [m] from lift height, and from above the goal
WAYPOINT_ANGLE = 0.2  # [rad]
SETTLED_DISTANCE = 0.0015  # [m]
SETTLED_ANGLE = 0.01  # [rad]
HOVER = 0.004
"""Height over the goal at which a descending hand waits that is aside of it [m].

An arm whose joints still swing after a turn pulls the hand aside, by up to 10 mm, and down."""
ASIDE = 0.002  # [m] in the plane, about where it is settled, from which on it waits
SLOW_STEP = 0.001  # [m] a step, 20 mm/s: fingers that close earlier push things aside
STALL_STEPS = 8
STALL_DISTANCE = 0.0003  # [m] a step
STALL_ANGLE = 0.003  # [rad] a step
BLOCKED_STEPS = 3
BLOCKED_HEIGHT = 0.008  # [m] that are left to descend
BLOCKED_DESCENT = 0.002  # [m] a step


def move_while(
    unfinished: Callable[[Scene], bool], scene: Scene, goal: Array, mover: Mover
) -> Phase:
    """Head for a goal as long as a condition holds and the gripper moves.

    Args:
        unfinished: Asked before each step.
        scene: Where it starts.
        goal: ``(4,)``.
        mover: Makes the actions.
    """
    still = 0
    while unfinished(scene) and still < STALL_STEPS:
        before, scene = scene, (yield mover.action(scene, goal))
        still = still + 1 if is_still(before, scene) else 0
    return scene


def approach(scene: Scene, goal: Array, mover: Mover) -> Phase:
    """Lift, travel above the goal, descend and settle there.

    The height of travel is a constant of the scene. Were it the present height where that is
    greater, every motion would start from where the last one had drifted up to.

    Args:
        scene: Where it starts.
        goal: ``(4,)``.
        mover: Makes the actions.
    """
    lift_height = scene.description.lift_height
    if not is_above(scene, goal):
        lifted = gripper_goal(scene)
        lifted[2] = lift_height
        low = lift_height - WAYPOINT_DISTANCE
        scene = yield from move_while(
            lambda now: bool(now.gripper_position[2] < low), scene, lifted, mover
        )
        above = np.array([goal[0], goal[1], lift_height, goal[3]])
        scene = yield from move_while(lambda now: not is_above(now, goal), scene, above, mover)
    return (yield from settle(scene, goal, mover, HOVER))


def settle(scene: Scene, goal: Array, mover: Mover, hover: float = 0.0) -> Phase:
    """Head for a goal until the gripper is there, stands still or stands on something.

    It takes at least one step.

    Args:
        scene: Where it starts.
        goal: ``(4,)``.
        mover: Makes the actions.
        hover: How far above the goal it stays at most while it is aside of it [m].
    """
    still = blocked = 0
    while still < STALL_STEPS and blocked < BLOCKED_STEPS:
        aside = plane_distance(scene, goal) - ASIDE
        target = goal + np.array([0.0, 0.0, float(np.clip(aside, 0.0, hover)), 0.0])
        before, scene = scene, (yield mover.action(scene, target))
        if is_settled(scene, goal) and is_slow(before, scene):
            break
        still = still + 1 if is_still(before, scene) else 0
        blocked = blocked + 1 if is_blocked(before, scene, target) else 0
    return scene


def rest(scene: Scene, goal: Array, mover: Mover) -> Generator[Action, Scene, Scene | None]:
    """Stay at a goal until the gripper is slow; it takes at least one step.

    An approach that ended because something was in the way may still be moving.

    Args:
        scene: Where it starts.
        goal: ``(4,)``.
        mover: Makes the actions.

    Returns:
        The last scene, or None if the gripper does not come to rest.
    """
    for _ in range(STALL_STEPS):
        before, scene = scene, (yield mover.action(scene, goal))
        if is_slow(before, scene):
            return scene
    return None


def hold(scene: Scene, goal: Array, mover: Mover, steps: int) -> Phase:
    """Stay at a goal for some steps, while the gripper opens or closes.

    Args:
        scene: Where it starts.
        goal: ``(4,)``.
        mover: Makes the actions.
        steps: How many.
    """
    for _ in range(steps):
        scene = yield mover.action(scene, goal)
    return scene


def at_most(steps: int, scene: Scene, phase: Phase) -> Phase:
    """Cut a phase off.

    Args:
        steps: Motor actions that it may take.
        scene: Where it starts.
        phase: The phase, not yet begun.
    """
    try:
        action = next(phase)
        for _ in range(steps):
            scene = yield action
            action = phase.send(scene)
    except StopIteration as end:
        last: Scene = end.value
        return last
    phase.close()
    return scene


def is_above(scene: Scene, goal: Array) -> bool:
    """Whether the gripper may descend (or rise) to a goal."""
    near = plane_distance(scene, goal) < WAYPOINT_DISTANCE
    return near and jaw_distance(scene, goal[3]) < WAYPOINT_ANGLE


def is_settled(scene: Scene, goal: Array) -> bool:
    """Whether the gripper is where it should be, closer than success asks for."""
    near = distance(scene, goal) < SETTLED_DISTANCE
    return near and jaw_distance(scene, goal[3]) < SETTLED_ANGLE


def is_slow(before: Scene, after: Scene) -> bool:
    """Whether the gripper moves so slowly that it stays where it is when it is told to."""
    return distance(after, before.gripper_position) < SLOW_STEP


def is_still(before: Scene, after: Scene) -> bool:
    """Whether the gripper hardly moved in a step."""
    near = distance(after, before.gripper_position) < STALL_DISTANCE
    return near and jaw_distance(after, before.gripper_yaw) < STALL_ANGLE


def is_blocked(before: Scene, after: Scene, goal: Array) -> bool:
    """Whether the gripper should descend and does not: what it holds stands on something."""
    left = after.gripper_position[2] - goal[2]
    descent = before.gripper_position[2] - after.gripper_position[2]
    over = plane_distance(after, goal) < WAYPOINT_DISTANCE
    return bool(over and left > BLOCKED_HEIGHT and descent < BLOCKED_DESCENT)

"""What the policy of a learned primitive is trained on: segments, each in the frame of its call."""

import numpy as np

from prime_core.affordances.goals import JAW_PERIOD
from prime_core.arrays import Array, Flags, Floats, Indices
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.primitive import PrimitiveExamples
from prime_core.contracts.scene import EMPTY_OPENING, STILL_FINGERS
from prime_core.rotations import wrap_angle
from prime_primitives_learned.disturbances import COPIES, Path, disturbed
from prime_primitives_learned.frame import CallFrame, ParameterPlaces

ENDINGS = 10
"""Times that the last frame of a segment is shown with the word that the motion is over. One frame
of a hundred would hardly count."""

LEAST_MOVE = 0.001
"""Position and yaw that an action changes at the least, or the hand waits [m, rad]."""


def motor_demonstrations(
    examples: PrimitiveExamples, generator: np.random.Generator
) -> list[Demonstration]:
    """Return segments as demonstrations of six numbers an action, each also disturbed.

    The sixth says whether the motion is over: -1 in the frames of the segment but the last, 1 in
    that, which is repeated, with actions that hold still.

    Args:
        examples: The segments.
        generator: Of the disturbances.
    """
    places = ParameterPlaces(examples.space)
    found = []
    for execution, parameters in zip(examples.executions, examples.parameters, strict=True):
        rows = np.append(useful_frames(execution), np.full(ENDINGS, execution.steps))
        call, path = achieved(places, execution, parameters), _path(execution, rows)
        openings = execution.observations.gripper_opening[rows].astype(np.float64)
        free = np.abs(np.gradient(openings)) < STILL_FINGERS
        holding = holding_in(execution)[rows]
        copies = (disturbed(path, call[places.point], free, generator) for _ in range(COPIES))
        for way in (path, *copies):
            frame = CallFrame(places, call, way.positions[0], float(way.yaws[0]))
            observations = frame.observations(way.positions, way.yaws, openings, holding)
            actions = np.column_stack((frame.actions_in(way.actions[:, :5]), way.actions[:, 5]))
            found.append(Demonstration(observations, actions.astype(np.float32), execution.task))
    return found


def _path(execution: Demonstration, rows: Indices) -> Path:
    """Return what the gripper did in some frames; in the last one it holds still, it is over."""
    seen, over = execution.observations, rows >= execution.steps
    actions = np.column_stack((execution.actions[rows], np.where(over, 1.0, -1.0)))
    actions[over, :4] = 0.0
    actions[over, 4] = execution.actions[max(execution.steps - 1, 0), 4]
    return Path(seen.gripper_position[rows].astype(np.float64), seen.gripper_yaw[rows], actions)


def achieved(places: ParameterPlaces, execution: Demonstration, parameters: Array) -> Array:
    """Return the parameters of a segment, with the pose that the gripper really came to.

    Those of the segment are an inverse dynamics model's, or a person's, and some millimetres off;
    heights of places are centimetres off, for what is let go of falls. The pose is the gripper's
    when it comes to hold something or lets go of it, or at the end where neither happens. One with
    a displacement stays as it is: no single frame tells where a push began.
    """
    if places.displacement:
        return parameters
    held = holding_in(execution)
    changes = np.flatnonzero(held != held[0])
    frame = int(changes[0]) if len(changes) else -1
    seen, result = execution.observations, np.array(parameters)
    result[places.point] = seen.gripper_position[frame]
    if places.yaw is not None:
        result[places.yaw] = wrap_angle(seen.gripper_yaw[frame], JAW_PERIOD)
    return result


def useful_frames(execution: Demonstration) -> Indices:
    """Return the frames of a segment that a motion is learned from, in order, but for the last.

    People wait, and try again. Frames in which neither hand nor fingers move teach to wait for
    ever. What comes before the gripper's last command but one was an attempt that failed, as a
    grasp that closed on nothing and opened again: the motion begins after it.
    """
    actions, openings = execution.actions[:-1], execution.observations.gripper_opening
    closing = actions[:, 4] > 0
    changes = np.flatnonzero(closing[1:] != closing[:-1]) + 1
    first = int(changes[-2]) if len(changes) > 1 else 0
    moves = (np.abs(actions[:, :4]) > LEAST_MOVE).any(axis=1)
    moves |= np.abs(np.diff(openings)) > STILL_FINGERS
    moves[changes] = True  # the fingers begin to move in the next frame
    frames: Indices = np.flatnonzero(moves)
    return frames[frames >= first]


def holding_in(execution: Demonstration) -> Flags:
    """Return whether the gripper holds something in each frame, ``(N,)``.

    Known of the objects where they are known, else told from the gripper as `Scene.holding` does.
    """
    seen = execution.observations
    if seen.environment_state is not None and seen.environment_state.shape[1]:
        return np.asarray(seen.held.any(axis=1))
    openings: Floats = seen.gripper_opening.astype(np.float64)
    before = np.append(openings[:1], openings[:-1])
    commands = np.append(execution.actions[:1, 4], execution.actions[:-1, 4])
    still = np.abs(openings - before) <= STILL_FINGERS
    return np.asarray((commands > 0) & still & (openings > EMPTY_OPENING))

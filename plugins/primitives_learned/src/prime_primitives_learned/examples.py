"""What the policy of a learned primitive is trained on: segments, each in the frame of its call."""

import numpy as np

from prime_core.arrays import Flags, Floats
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.primitive import PrimitiveExamples
from prime_core.contracts.scene import EMPTY_OPENING, STILL_FINGERS
from prime_primitives_learned.frame import CallFrame, ParameterPlaces

ENDINGS = 10
"""Times that the last frame of a segment is shown with the word that the motion is over. One frame
of a hundred would hardly count."""


def motor_demonstrations(examples: PrimitiveExamples) -> list[Demonstration]:
    """Return segments as demonstrations of six numbers an action.

    The sixth says whether the motion is over: -1 in the frames of the segment but the last, 1 in
    that, which is repeated, with actions that hold still.
    """
    places = ParameterPlaces(examples.space)
    found = []
    for execution, parameters in zip(examples.executions, examples.parameters, strict=True):
        seen, steps = execution.observations, execution.steps
        frame = CallFrame(places, parameters, float(seen.gripper_yaw[0]))
        rows = np.append(np.arange(steps), np.full(ENDINGS, steps))
        observations = frame.observations(
            seen.gripper_position[rows].astype(np.float64),
            seen.gripper_yaw[rows],
            seen.gripper_opening[rows].astype(np.float64),
            holding_in(execution)[rows],
        )
        actions = np.zeros((len(rows), 6))
        actions[:steps, :5] = frame.actions_in(execution.actions[:steps])
        actions[steps:, 4] = execution.actions[max(steps - 1, 0), 4]
        actions[:, 5] = np.where(rows < steps, -1.0, 1.0)
        found.append(Demonstration(observations, actions.astype(np.float32), execution.task))
    return found


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

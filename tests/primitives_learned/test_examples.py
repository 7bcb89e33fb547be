"""What is learned from segments: useful frames, the pose that was reached, disturbed copies."""

import numpy as np
import pytest

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.observations import Observations
from prime_core.learning.primitive_examples import primitive_examples
from prime_core.rotations import gripper_down
from prime_primitives_learned.disturbances import COPIES, Path, disturbed
from prime_primitives_learned.examples import (
    ENDINGS,
    achieved,
    holding_in,
    motor_demonstrations,
    useful_frames,
)
from prime_primitives_learned.frame import ParameterPlaces
from prime_primitives_learned.statistics import statistics_of

from .conftest import Shown


def execution(commands: list[float], openings: list[float], moves: list[float]) -> Demonstration:
    count = len(commands)
    state = np.zeros((count, 8), dtype=np.float32)
    state[:, 3:7], state[:, 7] = gripper_down(0.0), openings
    actions = np.zeros((count, 5), dtype=np.float32)
    actions[:, 0], actions[:, 4] = moves, commands
    return Demonstration(Observations(state), actions, "a made-up task")


def test_waiting_is_not_learned_nor_an_attempt_that_failed() -> None:
    commands = [-1.0] * 3 + [1.0] * 3 + [-1.0] * 4 + [1.0] * 4
    openings = [0.08] * 3 + [0.06, 0.02, 0.0] + [0.02, 0.06, 0.08, 0.08] + [0.08, 0.06, 0.04, 0.04]
    moves = [0.02] * 3 + [0.0] * 6 + [0.02] + [0.0] * 4
    shown = execution(commands, openings, moves)
    frames = useful_frames(shown)
    assert frames[0] == 6  # where it opened again after it had closed on nothing
    assert frames.tolist() == [6, 7, 9, 10, 11]  # 8 and 12 wait; 13 is the last frame


def test_what_is_held_is_told_from_the_gripper_where_objects_are_not_known() -> None:
    shown = execution([-1.0, 1.0, 1.0, 1.0, 1.0], [0.08, 0.08, 0.05, 0.04, 0.04], [0.0] * 5)
    assert holding_in(shown).tolist() == [False, False, False, False, True]


def test_segments_become_demonstrations_with_an_end(shown: Shown) -> None:
    examples = primitive_examples(shown.dataset)["grasp"]
    made = motor_demonstrations(examples, np.random.default_rng(0))
    assert len(made) == len(examples.executions) * (1 + COPIES)
    for item in made:
        over = item.actions[:, 5]
        assert (over[:-ENDINGS] == -1).all()
    for item in made[:: 1 + COPIES]:  # as they were shown
        assert (item.actions[-ENDINGS:, 5] == 1).all()
        assert np.abs(item.actions[-ENDINGS:, :4]).max() == 0.0
    disturbed_endings = [item.actions[-ENDINGS:, 5] for item in made]
    assert np.concatenate(disturbed_endings).min() == -1  # it is not over beside the goal
    again = motor_demonstrations(examples, np.random.default_rng(0))
    assert all(np.array_equal(a.actions, b.actions) for a, b in zip(made, again, strict=True))


def test_the_pose_that_was_reached_takes_the_place_of_the_one_that_was_told(shown: Shown) -> None:
    examples = primitive_examples(shown.dataset)["grasp"]
    places = ParameterPlaces(examples.space)
    for execution_, told in zip(examples.executions, examples.parameters, strict=True):
        wrong = told + np.array([0.0, 0.0, 0.05, 0.0])
        np.testing.assert_allclose(achieved(places, execution_, wrong)[:3], told[:3], atol=0.004)


def test_disturbed_paths_lead_back_to_the_path_that_was_shown() -> None:
    steps = 60
    positions = np.linspace([0.0, 0.0, 0.3], [0.2, 0.1, 0.0], steps)
    actions = np.zeros((steps, 6))
    actions[:-1, :3] = np.diff(positions, axis=0)
    path, goal = Path(positions, np.zeros(steps), actions), positions[-1]
    free = np.arange(steps) == 5
    found = 0
    for seed in range(40):
        made = disturbed(path, goal, free, np.random.default_rng(seed))
        off = np.linalg.norm(made.positions - path.positions, axis=1)
        if off[5] == 0:
            continue
        found += 1
        # Each action leads from where the hand is to where it is shown next.
        np.testing.assert_allclose(
            (made.positions + made.actions[:, :3])[5:-1], made.positions[6:], atol=1e-12
        )
        assert off[-1] < 1e-4 < off[5]
    assert found


def test_statistics_of_grasps(shown: Shown) -> None:
    found = statistics_of(primitive_examples(shown.dataset)["grasp"])
    assert (found.holds_before, found.holds_after, found.moves) == (False, True, False)
    assert found.segments == 6
    offsets = np.array(found.relative_parameters)
    assert np.abs(offsets[:, :2]).max() < 0.02  # a grasp goes to the cube
    assert [item.name for item in found.space.parameters] == ["x", "y", "z", "yaw"]
    with pytest.raises(ValueError, match="segments"):
        found.model_validate({**found.model_dump(), "segments": 0})

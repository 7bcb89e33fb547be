"""Trials: of policies of either kind, judged from all that the environment knows."""

from collections.abc import Sequence

import numpy as np
import pytest

from prime_core.arrays import Array
from prime_core.contracts.environment import Action
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import MotorPolicy
from prime_core.contracts.scene import Scene
from prime_core.execution.trial import run_trial

from ..point_mass import SOLVED_HEIGHT, PointMass
from .toys import Chooses, Rise, asks, run_by


class Climb(MotorPolicy):
    """Rises until it gives up."""

    def __init__(self, patience: int) -> None:
        self.patience = patience
        self.seen: list[Observations] = []

    def reset(self, generator: np.random.Generator) -> None:
        self.seen = []

    def act(self, seen: Observations) -> Action | None:
        self.seen.append(seen)
        if len(self.seen) > self.patience:
            return None
        return np.array([0.0, 0.0, 0.02, 0.0, 0.0])


def test_a_policy_of_motor_actions_acts_until_the_task_is_solved() -> None:
    scenes: list[Scene] = []
    policy = Climb(patience=50)
    trial = run_trial(PointMass(), [], policy, np.random.default_rng(0), 50, scenes.append)
    assert (trial.success, trial.steps, trial.calls, trial.completed) == (True, 8, (), ())
    assert [round(float(scene.gripper_position[2]), 9) for scene in scenes] == [
        round(0.9 + 0.02 * number, 9) for number in range(1, 9)
    ]
    assert scenes[-1].gripper_position[2] > SOLVED_HEIGHT
    assert {len(seen) for seen in policy.seen} == {1}


@pytest.mark.parametrize(("patience", "limit", "steps"), [(3, 50, 3), (0, 50, 0), (50, 4, 4)])
def test_a_trial_ends_where_a_policy_gives_up_or_its_steps_are_used_up(
    patience: int, limit: int, steps: int
) -> None:
    trial = run_trial(PointMass(), [], Climb(patience), np.random.default_rng(0), limit)
    assert (trial.success, trial.steps) == (False, steps)


@pytest.mark.parametrize(("sees", "told"), [(("proprioception",), False), (("objects",), True)])
def test_a_policy_of_motor_actions_is_given_what_it_sees(sees: tuple[str, ...], told: bool) -> None:
    policy = Climb(patience=3)
    policy.sees = sees  # type: ignore[assignment]
    run_trial(PointMass(), [], policy, np.random.default_rng(0), 3)
    assert [seen.environment_state is not None for seen in policy.seen] == [told] * 3


class Finds(Rise):
    """Did what it is for if an object lies to the right of a place in every scene."""

    def __init__(self, place: float) -> None:
        self.place = place
        self.judged: list[list[Scene]] = []

    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        self.judged.append(list(scenes))
        return all(scene.object_positions[0, 0] > self.place for scene in scenes)


@pytest.mark.parametrize(("place", "completed"), [(-1.0, True), (1.0, False)])
def test_whether_calls_did_what_they_are_for_is_judged_from_all_objects(
    place: float, completed: bool
) -> None:
    finds, environment = Finds(place), PointMass()
    policy = Chooses(asks([0.96, 1.0]).choice, sees=("proprioception",))
    trial = run_trial(environment, [finds], run_by(policy, finds), np.random.default_rng(0), 4)
    assert trial.completed == (completed,) * 3
    # The first call takes two steps, then it ends at once, each time at the cost of a step.
    heights = [[round(float(item.gripper_position[2]), 6) for item in row] for row in finds.judged]
    assert heights == [[0.9, 0.95, 1.0], [1.0, 1.0], [1.0, 1.0]]
    # As the environment knows them, not as the policy's vectors tell them.
    truth = environment.scene().object_positions
    assert all(np.array_equal(item.object_positions, truth) for item in finds.judged[0])

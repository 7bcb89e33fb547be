"""Parsed demonstrations are executed from their first states, with `other` segments or without."""

import numpy as np
import pytest

from prime_core.arrays import Floats
from prime_core.contracts.calls import OTHER, PrimitiveCall
from prime_core.contracts.demonstration import Demonstration, ParsedDemonstration, Segment
from prime_core.contracts.environment import Action, Observation
from prime_core.contracts.observations import Observations
from prime_core.errors import PrimeError
from prime_core.execution.replay import REST_STEPS, SequenceRunner, replay_demonstration

from ..point_mass import PointMass
from .toys import Rise

RECORDED = [0.0, 0.03, 0.0, 0.0, 1.0]
"""The motor action of the segments that no primitive explains."""


class Recorded(PointMass):
    """Keeps the actions; solved where the gripper has moved along y and then held still."""

    def __init__(self, still_steps: int = 1000) -> None:
        super().__init__()
        self.actions: list[list[float]] = []
        self.still_steps = still_steps

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, object]]:
        self.actions.append(action.tolist())
        return super().step(action)

    def is_success(self) -> bool:
        last = np.array(self.actions[-self.still_steps :])
        return len(last) == self.still_steps and not last[:, :4].any()


def first_state() -> Floats:
    environment = PointMass()
    environment.reset(seed=5)
    environment.values[:3] = 0.1, 0.1, 0.8
    return environment.get_state()


def parsed(simulated: bool = True) -> ParsedDemonstration:
    """Return a rise, three actions of `other`, and another rise, which ends at once."""
    environment = PointMass()
    environment.set_state(first_state())
    seen = [Observations.single(environment.observe())] * 11
    pieces = [(0, 4, "rise", [0.93]), (4, 7, OTHER, []), (7, 10, "rise", [0.5])]
    segments = [
        Segment(start, end, PrimitiveCall(name, np.array(values)), 0.0)
        for start, end, name, values in pieces
    ]
    states = np.tile(first_state(), (11, 1)) if simulated else None
    actions = np.tile(np.array(RECORDED, dtype=np.float32), (11, 1))
    shown = Demonstration(Observations.join(seen), actions, "rise", states)
    return ParsedDemonstration(shown, tuple(segments))


RISE = [0.0, 0.0, 0.05, 0.0, 0.0]
OTHERS = [[pytest.approx(value, abs=1e-7) for value in RECORDED]] * 3


def hold(gripper: float) -> list[float]:
    return [0.0, 0.0, 0.0, 0.0, gripper]


@pytest.mark.parametrize(
    ("replay_other", "actions"),
    [
        # The second rise is over at once and costs a step; then the hand rests, as it was.
        (True, [*[RISE] * 3, *OTHERS, hold(1.0), *[hold(1.0)] * REST_STEPS]),
        (False, [*[RISE] * 3, hold(0.0), *[hold(0.0)] * REST_STEPS]),
    ],
)
def test_segments_are_run_one_after_another_then_the_hand_rests(
    replay_other: bool, actions: list[list[float]]
) -> None:
    environment = Recorded()
    replay = replay_demonstration(environment, [Rise()], parsed(), replay_other=replay_other)
    assert environment.actions == actions
    assert (replay.success, replay.steps) == (False, len(actions))
    assert replay.completed == (True, True)
    assert environment.values[:3] == pytest.approx([0.1, 0.1 + 0.09 * replay_other, 0.95])


def test_a_task_that_is_solved_while_the_hand_rests_is_solved() -> None:
    environment = Recorded(still_steps=6)
    replay = replay_demonstration(environment, [Rise()], parsed(), replay_other=True)
    assert replay.success
    assert replay.steps == 3 + 3 + 6


def test_a_demonstration_without_states_is_refused() -> None:
    with pytest.raises(PrimeError, match=r"no simulator states.*can be parsed, but not replayed"):
        replay_demonstration(Recorded(), [Rise()], parsed(simulated=False), replay_other=True)


def test_a_runner_of_segments_begins_again_when_it_is_reset() -> None:
    environment = PointMass()
    runner = SequenceRunner(environment.description, [Rise()], parsed(), replay_other=True)
    episodes = []
    for _ in range(2):
        environment.set_state(first_state())
        runner.reset(np.random.default_rng(0))
        actions = []
        while (action := runner.act(Observations.single(environment.observe()))) is not None:
            environment.step(action)
            actions.append(action.tolist())
        episodes.append(actions)
        assert [(record.start, record.end) for record in runner.records] == [(0, 3), (6, 7)]
    assert episodes[0] == episodes[1]
    assert len(episodes[0]) == 3 + 3 + 1 + REST_STEPS

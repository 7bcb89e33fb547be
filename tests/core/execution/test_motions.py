"""One motion after another, scene in, motor action out."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.arrays import Array
from prime_core.contracts.environment import ACTION_LIMIT, Action
from prime_core.contracts.primitive import Motion
from prime_core.contracts.scene import Scene
from prime_core.execution.motions import (
    MotionRun,
    hold_action,
    run_actions,
    run_primitive,
    settle,
    step,
)

from ..point_mass import PointMass
from .toys import Rise


@pytest.fixture
def environment() -> PointMass:
    environment = PointMass()
    environment.reset(seed=0)
    return environment


class Closes(Rise):
    """Says when its generator was closed."""

    maximum_steps = 2
    closed = False

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        try:
            while True:
                yield np.zeros(5)
        finally:
            self.closed = True


def test_a_motion_is_stopped_and_closed_at_its_limit(environment: PointMass) -> None:
    closes, scene = Closes(), environment.scene()
    run = MotionRun(closes, scene, np.array([1.0]))
    assert [run.next_action(scene) is None for _ in range(4)] == [False, False, True, True]
    assert (run.steps, run.finished, closes.closed) == (2, False, True)


def test_a_motion_that_ends_itself_is_finished(environment: PointMass) -> None:
    execution = run_primitive(environment, Rise(), np.array([0.98]))
    assert (execution.steps, execution.finished, len(execution.scenes)) == (2, True, 3)
    cut = run_primitive(environment, Closes(), np.array([1.0]))
    assert (cut.steps, cut.finished) == (2, False)


def test_a_motion_is_closed_where_the_environment_fails(environment: PointMass) -> None:
    class Breaks(PointMass):
        def step(self, action: Action) -> object:  # type: ignore[override]
            raise RuntimeError("the arm is gone")

    broken, closes = Breaks(), Closes()
    broken.reset(seed=0)
    with pytest.raises(RuntimeError, match="the arm is gone"):
        run_primitive(broken, closes, np.array([1.0]))
    assert closes.closed


def test_actions_are_clipped_and_given_back(environment: PointMass) -> None:
    step(environment, 10 * ACTION_LIMIT)
    assert environment.values[2] == pytest.approx(0.95)
    execution = run_actions(environment, np.tile(np.float32([0, 0, 0.01, 0, 0]), (3, 1)))
    assert execution.actions.shape == (3, 5)
    assert environment.values[2] == pytest.approx(0.98)


@pytest.mark.parametrize(
    ("held", "last", "command"),
    [(None, None, -1.0), ("cube", None, 1.0), ("cube", -0.3, -0.3), (None, 0.7, 0.7)],
)
def test_holding_still_keeps_the_grippers_command(
    environment: PointMass, held: str | None, last: float | None, command: float
) -> None:
    scene = environment.scene()
    scene = replace(scene, objects=replace(scene.known_objects, held=held))
    before = None if last is None else np.array([0.1, 0.1, 0.1, 0.1, last])
    assert hold_action(scene, before).tolist() == [0.0, 0.0, 0.0, 0.0, command]


def test_settling_ends_once_nothing_moves(environment: PointMass) -> None:
    assert settle(environment).steps == 1

    class Rolls(PointMass):
        def scene(self) -> Scene:
            self.values[5] += self.speed
            self.speed *= 0.5
            return super().scene()

        speed = 0.01

    rolls = Rolls()
    rolls.reset(seed=0)
    execution = settle(rolls)
    assert execution.finished
    ways = np.diff([scene.object_positions[0, 0] for scene in execution.scenes])
    assert np.all(ways[:-1] >= 5e-4) and ways[-1] < 5e-4
    assert not settle(rolls, step_limit=0).finished

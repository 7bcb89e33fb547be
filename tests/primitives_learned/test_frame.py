"""What a learned primitive sees: the same wherever a call is, and from whatever side it comes."""

import numpy as np
import pytest

from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.errors import DatasetError
from prime_core.rotations import wrap_angle
from prime_primitives_learned.frame import CallFrame, ParameterPlaces, turned

POSE = [Parameter(name, "m", -1.0, 1.0) for name in "xyz"]
YAW = Parameter("yaw", "rad", -np.pi / 2, np.pi / 2, period=np.pi)
MOVE = [Parameter(name, "m", -0.4, 0.4) for name in ("dx", "dy", "dz")]
FORCE = Parameter("force", "N", 0.0, 10.0)
SPACE = ParameterSpace((*POSE, YAW, FORCE))
PUSH = ParameterSpace((*POSE, YAW, *MOVE))


def seen(
    space: ParameterSpace, parameters: np.ndarray, position: np.ndarray, yaw: float
) -> np.ndarray:
    frame = CallFrame(ParameterPlaces(space), parameters, position, yaw)
    ways = position + np.array([[0.0, 0.0, 0.0], [0.01, 0.02, 0.03]]) @ rotation(yaw)
    found = frame.observations(ways, np.full(2, yaw), np.full(2, 0.08), np.array([False, True]))
    assert found.environment_state is not None
    return np.hstack((found.state, found.environment_state))


def rotation(yaw: float) -> np.ndarray:
    return np.array(turned(np.eye(3), yaw))


@pytest.mark.parametrize("space", [SPACE, PUSH])
def test_a_call_looks_the_same_turned_and_moved(space: ParameterSpace) -> None:
    generator = np.random.default_rng(0)
    places = ParameterPlaces(space)
    parameters = np.append(generator.uniform(-0.3, 0.3, 4), generator.uniform(0.1, 0.3, 3))
    parameters = parameters[: len(space)]
    position, yaw, turn = np.array([0.2, 0.1, 0.3]), 0.4, 1.1
    shift = np.array([0.3, -0.2, 0.0])  # of another height it would not look the same
    moved = places.placed_at(parameters, shift, turn)
    there = turned(position, turn) + shift
    np.testing.assert_allclose(
        seen(space, parameters, position, yaw),
        seen(space, moved, there, float(wrap_angle(yaw + turn))),
        atol=1e-6,
    )
    np.testing.assert_allclose(places.seen_from(moved, shift, turn), parameters, atol=1e-9)


def test_numbers_that_are_no_pose_are_seen_too() -> None:
    parameters = np.array([0.1, 0.2, 0.3, 0.4, 7.0])
    start = np.array([0.0, 0.0, 0.5])
    first = seen(SPACE, parameters, start, 0.0)
    parameters[4] = 8.0
    assert np.abs(seen(SPACE, parameters, start, 0.0) - first).max() == pytest.approx(1.0)


def test_actions_come_back_as_they_were() -> None:
    frame = CallFrame(ParameterPlaces(PUSH), np.arange(7) / 10, np.zeros(3), 0.3)
    actions = np.random.default_rng(1).normal(size=(4, 5))
    inside = frame.actions_in(actions)
    assert not np.allclose(inside, actions)
    for before, after in zip(actions, inside, strict=True):
        np.testing.assert_allclose(frame.action_out(after), before, atol=1e-12)


def test_where_it_goes_must_be_known() -> None:
    with pytest.raises(DatasetError, match=r"parameters \['yaw'\] cannot be learned: x, y, z"):
        ParameterPlaces(ParameterSpace((YAW,)))

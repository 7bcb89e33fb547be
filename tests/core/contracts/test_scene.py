"""Scenes: with objects and without, and as observations."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.checks.samples import DESCRIPTION, sample_observations
from prime_core.contracts.observations import Observations
from prime_core.contracts.scene import EMPTY_OPENING, STILL_FINGERS, ObjectPoses, Scene
from prime_core.errors import PrimeError, UnknownObjectsError


def seen(count: int = 1, seed: int = 0) -> Observations:
    return sample_observations(np.random.default_rng(seed), count)


def blind(opening: float, command: float | None) -> Scene:
    scene = Scene.read(DESCRIPTION, seen().only(["proprioception"]), command)
    return replace(scene, gripper_opening=opening)


@pytest.mark.parametrize(
    ("opening", "command", "holding"),
    [
        (0.04, 1.0, True),
        (0.04, 0.1, True),
        (0.04, -1.0, False),
        (0.04, 0.0, False),
        (0.04, None, False),  # Not known: nothing says that it holds.
        (EMPTY_OPENING, 1.0, False),
        (EMPTY_OPENING + 1e-4, 1.0, True),
        (0.0, 1.0, False),
    ],
)
def test_without_objects_holding_is_told_from_the_gripper(
    opening: float, command: float | None, holding: bool
) -> None:
    assert blind(opening, command).holding is holding


@pytest.mark.parametrize(
    ("change", "holding"), [(0.0, True), (STILL_FINGERS / 2, True), (2 * STILL_FINGERS, False)]
)
def test_fingers_on_their_way_hold_nothing_yet(change: float, holding: bool) -> None:
    alone = seen().only(["proprioception"])
    state = alone.state.copy()
    state[:, 7] = 0.04
    scene = Scene.read(DESCRIPTION, replace(alone, state=state), 1.0, 0.04 + change)
    assert scene.holding is holding


@pytest.mark.parametrize(("held", "holding"), [(None, False), ("cube", True)])
def test_with_objects_holding_is_what_is_held(held: str | None, holding: bool) -> None:
    # The gripper's opening and command say the opposite.
    scene = Scene.read(DESCRIPTION, seen(), gripper_command=-1.0 if holding else 1.0)
    scene = replace(scene, objects=replace(scene.known_objects, held=held), gripper_opening=0.04)
    assert scene.holding is holding
    assert scene.held == held


@pytest.mark.parametrize(
    "name", ["held", "object_positions", "object_quaternions", "known_objects"]
)
def test_where_objects_are_is_not_made_up(name: str) -> None:
    with pytest.raises(UnknownObjectsError) as raised:
        getattr(blind(0.04, 1.0), name)
    assert isinstance(raised.value, PrimeError)
    assert str(raised.value) == (
        "object poses are asked for, but this scene does not tell them: only models that see "
        "objects, priors and success criteria may look at them"
    )


@pytest.mark.parametrize("row", range(6))
def test_a_scene_reads_one_observation_and_gives_it_back(row: int) -> None:
    one = seen(6, seed=1)[row : row + 1]
    scene = Scene.read(DESCRIPTION, one, gripper_command=0.5)
    assert scene.gripper_command == 0.5
    np.testing.assert_array_equal(scene.gripper_position, one.gripper_position[0])
    np.testing.assert_array_equal(scene.joint_positions, one.joint_positions[0])
    np.testing.assert_array_equal(scene.object_positions, one.object_positions[0])
    assert scene.gripper_yaw == pytest.approx(one.gripper_yaw[0])
    assert scene.held == ("cube" if one.held[0, 0] else None)
    again = Observations.single(scene.observation())
    np.testing.assert_array_equal(again.state, one.state)
    assert again.environment_state is not None and one.environment_state is not None
    np.testing.assert_array_equal(again.environment_state, one.environment_state)


def test_the_rows_above_hold_something_and_nothing() -> None:
    assert len(set(seen(6, seed=1).held[:, 0].tolist())) == 2


def test_a_scene_without_objects_observes_none() -> None:
    scene = blind(0.04, 1.0)
    assert scene.objects is None
    assert set(scene.observation()) == {"observation.state"}
    assert Observations.single(scene.observation()).environment_state is None


def test_a_scene_of_no_objects_knows_that_there_are_none() -> None:
    nothing = ObjectPoses(np.empty((0, 3)), np.empty((0, 4)), held=None)
    description = replace(DESCRIPTION, objects=(), affordances=())
    scene = replace(blind(0.04, 1.0), description=description, objects=nothing)
    assert scene.held is None
    assert not scene.holding
    assert scene.observation()["observation.environment_state"].shape == (0,)
    read = Scene.read(description, Observations.single(scene.observation()))
    assert read.object_positions.shape == (0, 3)
    assert read.held is None


def test_objects_are_found_by_their_names() -> None:
    scene = Scene.read(DESCRIPTION, seen())
    assert [scene.object_index(name) for name in ("cube", "plate")] == [0, 1]
    with pytest.raises(KeyError, match="spoon"):
        scene.object_index("spoon")

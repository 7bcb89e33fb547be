"""Where the priors draw from."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.contracts.description import Affordance, ObjectDescription
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle
from prime_primitives_scripted.grasp import GraspConfig
from prime_primitives_scripted.place import PlaceConfig
from prime_primitives_scripted.reach import ReachConfig

from .floating_gripper import DESCRIPTION, held_now, scene_at


def draws(primitive: Primitive, scene: Scene, count: int = 200) -> np.ndarray:
    generator = np.random.default_rng(0)
    return np.array([primitive.propose(scene, generator) for _ in range(count)])


def test_grasps_are_at_the_object_and_turn_with_it() -> None:
    turned = scene_at(block_yaw=0.4)
    drawn = draws(GraspConfig().build(DESCRIPTION), turned)
    assert np.abs(drawn[:, :2] - [0.1, -0.1]).max() < 0.006
    assert np.all((drawn[:, 2] > 0.83) & (drawn[:, 2] < 0.86))
    assert np.abs(drawn[:, 3] - 0.4).max() < 0.25


def test_of_equal_yaws_the_nearest_to_the_gripper_is_taken() -> None:
    four = replace(DESCRIPTION, objects=(ObjectDescription("block", yaw_symmetry=4),))
    scene = replace(scene_at(yaw=0.3, block_yaw=1.6), description=four)
    drawn = draws(GraspConfig(yaw_std=0.0).build(four), scene, 5)
    assert drawn[:, 3] == pytest.approx(1.6 - np.pi / 2)


def test_places_spread_in_height_and_free_yaws_over_all_angles() -> None:
    place = PlaceConfig().build(DESCRIPTION)
    drawn = draws(place, scene_at(held="block"))
    assert np.all((drawn[:, :2] > 0.05) & (drawn[:, :2] < 0.25))
    assert 0.02 < drawn[:, 2].std() < 0.04
    # Draws beyond the bounds are drawn again, not heaped up there.
    assert not np.any(np.isin(drawn[:, 2], [place.parameter_space.low[2], 1.1]))
    assert drawn[:, 3].min() < -1.3
    assert drawn[:, 3].max() > 1.3


def test_reach_goes_where_one_grasps_and_places() -> None:
    reach = ReachConfig().build(DESCRIPTION)
    empty = draws(reach, scene_at())
    assert {bool(item) for item in np.abs(empty[:, 1] + 0.1) < 0.03} == {True, False}
    holding = draws(reach, scene_at(held="block"))
    assert np.all(holding[:, 0] > 0.05)
    assert np.all(holding[:, 1] > 0.05)
    heights = holding[:, 2]
    assert {bool(item) for item in np.abs(heights - 1.0) < 0.05} == {True, False}


def test_declared_reaches_come_first() -> None:
    spot = Affordance("reach", None, (-0.2, 0.0, 1.0), (-0.2, 0.0, 1.0))
    description = replace(DESCRIPTION, affordances=(*DESCRIPTION.affordances, spot))
    drawn = draws(ReachConfig().build(description), replace(scene_at(), description=description))
    assert np.abs(drawn[:, 0] + 0.2).max() < 0.03


def test_without_usable_affordances_draws_are_uniform() -> None:
    scene = scene_at()
    scene.object_positions[0] = [5.0, 0.0, 0.0]
    drawn = draws(GraspConfig().build(DESCRIPTION), scene)
    assert drawn[:, 0].min() < -0.25
    assert drawn[:, 0].max() > 0.25


def test_draws_are_within_the_bounds() -> None:
    config = ReachConfig(position_std=(1.0, 1.0, 1.0), yaw_std=2.0)
    reach = config.build(DESCRIPTION)
    drawn = draws(reach, scene_at(), 50)
    assert all(reach.parameter_space.contains(item) for item in drawn)
    assert np.all(np.abs(drawn[:, 3]) <= np.pi / 2 + 1e-9)


def centres_of_held(drawn: np.ndarray, scene: Scene) -> np.ndarray:
    """Return x and y of the held block's centre once the gripper is at each draw, ``(N, 2)``."""
    away = scene.object_positions[0, :2] - scene.gripper_position[:2]
    turns = wrap_angle(drawn[:, 3] - scene.gripper_yaw, np.pi)
    turned = np.exp(1j * turns) * complex(*away)
    return drawn[:, :2] + np.stack((turned.real, turned.imag), axis=1)


def held_by_its_end(*affordances: Affordance) -> Scene:
    """Return a scene in which the gripper holds the block 6 cm from its centre."""
    description = replace(DESCRIPTION, affordances=affordances)
    scene = scene_at(position=(0.16, -0.1, 0.83), yaw=0.4, held="block", block_yaw=0.4)
    return replace(scene, description=description)


PEG = Affordance("place", None, (0.0, 0.1, 0.9), (0.0, 0.1, 0.9), of_held=True)


def test_what_is_held_is_brought_to_a_place_of_its_own_at_any_yaw() -> None:
    scene = held_by_its_end(PEG)
    place = PlaceConfig(position_std=(0.0, 0.0, 0.0), yaw_std=0.0).build(scene.description)
    drawn = draws(place, scene)
    assert np.ptp(drawn[:, 3]) > 2.0
    assert np.abs(centres_of_held(drawn, scene) - [0.0, 0.1]).max() < 1e-9
    assert drawn[:, 2] == pytest.approx(0.9 + 0.01)  # it is held 1 cm above its centre


def test_what_is_held_gets_the_yaws_of_its_place() -> None:
    scene = held_by_its_end(replace(PEG, yaws=(1.0, -3.0)))  # to -3.0 it would have to turn over
    place = PlaceConfig(position_std=(0.0, 0.0, 0.0), yaw_std=0.0).build(scene.description)
    drawn = draws(place, scene, 20)
    assert drawn[:, 3] == pytest.approx(1.0)
    assert np.abs(centres_of_held(drawn, scene) - [0.0, 0.1]).max() < 1e-9


def test_what_is_held_can_go_onto_another_object() -> None:
    onto = Affordance("place", "anvil", (0.01, 0.0, 0.05), (0.01, 0.0, 0.05), (0.0,), of_held=True)
    scene = held_by_its_end(onto)
    scene.object_quaternions[1] = [np.cos(0.1), 0.0, 0.0, np.sin(0.1)]
    place = PlaceConfig(position_std=(0.0, 0.0, 0.0), yaw_std=0.0).build(scene.description)
    drawn = draws(place, scene, 20)
    assert drawn[:, 3] == pytest.approx(0.2)
    spot = np.array([-0.2 + 0.01 * np.cos(0.2), 0.2 + 0.01 * np.sin(0.2)])
    assert np.abs(centres_of_held(drawn, scene) - spot).max() < 1e-9


def test_places_of_what_is_held_say_nothing_to_an_empty_gripper() -> None:
    above = Affordance("reach", None, (-0.2, 0.0, 1.0), (-0.2, 0.0, 1.0))
    scene = held_now(held_by_its_end(replace(PEG, action="reach"), above), None)
    drawn = draws(ReachConfig().build(scene.description), scene)
    assert np.abs(drawn[:, 0] + 0.2).max() < 0.03

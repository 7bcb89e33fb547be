"""Where the priors draw from."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.primitive import Primitive
from prime_core.scene import Affordance, ObjectDescription, Scene
from prime_primitives_scripted.grasp import GraspConfig
from prime_primitives_scripted.place import PlaceConfig
from prime_primitives_scripted.reach import ReachConfig

from .floating_gripper import DESCRIPTION, scene_at


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
    assert drawn[:, 2].std() > 0.05
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

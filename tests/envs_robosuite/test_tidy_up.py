"""TidyUp: starts, what counts as tidy, pushing, stepping."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import ArrayLike

from prime_core.checks import check_environment
from prime_core.errors import PrimeError
from prime_core.rotations import yaw_of
from prime_envs_robosuite.config import TidyUpConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.simulation.objects import Placement
from prime_envs_robosuite.tasks.tidy_up import LAYOUTS, TidyUpTask, Variant

from .conftest import Hand, far_apart, last_state, put, random_actions

VARIANTS: tuple[Variant, ...] = ("A", "B", "C", "D")
FLOOR = 0.84  # of the bins
IN_BIN = ([-0.15, -0.29, FLOOR + 0.0231], [-0.03, -0.31, FLOOR + 0.028])  # of variant D
ON_MAT = [0.13, 0.15, 0.824]
BESIDE = [-0.12, -0.10, 0.8231]  # the small box A on the table


def build(variant: Variant = "D", stepping: str = "compiled") -> RobosuiteEnvironment:
    environment = TidyUpConfig(variant=variant, stepping=stepping).build()  # type: ignore[arg-type]
    assert isinstance(environment, RobosuiteEnvironment)
    return environment


@pytest.fixture(scope="module")
def tidy() -> Iterator[RobosuiteEnvironment]:
    environment = build()
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def stock() -> RobosuiteEnvironment:
    return build(stepping="stock")


@pytest.mark.parametrize("variant", VARIANTS)
def test_each_variant_keeps_the_contract_and_starts_at_rest(variant: Variant) -> None:
    environment = build(variant)
    check_environment(environment)
    for seed in range(25):
        environment.reset(seed=seed)
        before = environment.scene()
        Hand(environment).grip(-1.0, 8)
        after = environment.scene()
        assert not environment.is_success()
        # Boxes that start in one another or in a bin jump apart.
        moved = np.abs(after.object_positions - before.object_positions)
        assert moved[:, :2].max() < 0.002
        assert moved[:, 2].max() < 0.006


def test_starts_fill_their_ranges(tidy: RobosuiteEnvironment) -> None:
    positions, yaws = [], []
    for seed in range(200):
        tidy.reset(seed=seed)
        scene = tidy.scene()
        positions.append(scene.object_positions)
        yaws.append([yaw_of(item) for item in scene.object_quaternions])
    low, high = np.min(positions, axis=0)[:, :2], np.max(positions, axis=0)[:, :2]
    boxes = LAYOUTS["D"].boxes
    expected_low = np.array([box.low for box in boxes])
    expected_high = np.array([box.high for box in boxes])
    assert np.all(low >= expected_low)
    assert np.all(high <= expected_high)
    np.testing.assert_allclose(low, expected_low, atol=0.01)
    np.testing.assert_allclose(high, expected_high, atol=0.01)
    assert 0.7 < np.max(np.abs(yaws)) <= np.pi / 4


def test_a_task_whose_objects_cannot_be_apart_is_refused() -> None:
    class Crowded(TidyUpTask):
        def placements(self, host: object) -> tuple[Placement, ...]:
            return (Placement((0.0, 0.0), (0.01, 0.01), 0.83),) * 3

    crowded = RobosuiteEnvironment(Crowded("D"))
    with pytest.raises(PrimeError, match="all objects apart was found in 1000 draws"):
        crowded.reset(seed=0)


@pytest.mark.parametrize("variant", VARIANTS)
def test_boxes_in_the_first_bin_and_on_the_second_mat_are_tidy(variant: Variant) -> None:
    environment = build(variant)
    layout = LAYOUTS[variant]
    x, y = layout.bins[0].centre
    small = [[x - 0.05, y, FLOOR + 0.0231], [x + 0.05, y, FLOOR + 0.028]]
    put(environment, *small, [*layout.mats[1].centre, 0.824])
    Hand(environment).grip(-1.0, 5)
    assert environment.is_success()
    put(environment, *small, [*layout.mats[0].centre, 0.824])
    assert not environment.is_success()


@pytest.mark.parametrize(
    "positions",
    [
        (BESIDE, IN_BIN[1], ON_MAT),
        ([-0.09, 0.29, FLOOR + 0.0231], IN_BIN[1], ON_MAT),  # in the other bin
        ([-0.09, -0.29, 0.8901], IN_BIN[1], ON_MAT),  # above the walls
        ([-0.09, -0.215, 0.87], IN_BIN[1], ON_MAT),  # beside a wall
        (*IN_BIN, [0.14, 0.034, 0.824]),  # 71 mm off
    ],
)
def test_near_misses_are_not_tidy(
    positions: tuple[ArrayLike, ...], tidy: RobosuiteEnvironment
) -> None:
    put(tidy, *IN_BIN, ON_MAT)
    assert tidy.is_success()
    put(tidy, *positions)
    assert not tidy.is_success()


def test_a_box_that_moves_is_not_tidy_yet(tidy: RobosuiteEnvironment) -> None:
    put(tidy, *IN_BIN, ON_MAT, speed=0.06)
    assert not tidy.is_success()
    Hand(tidy).grip(-1.0, 5)
    assert tidy.is_success()


def test_a_box_in_the_gripper_is_not_tidy_until_it_is_let_go_of(
    tidy: RobosuiteEnvironment,
) -> None:
    put(tidy, BESIDE, IN_BIN[1], ON_MAT)
    driver = Hand(tidy)
    driver.pick()
    assert tidy.scene().held == "small_box_a"
    over = [-0.13, -0.29, 0.95]
    driver.move(over, np.pi / 2, 1.0, 100)
    driver.move([-0.13, -0.29, 0.875], np.pi / 2, 1.0)
    inside = tidy.scene().object_positions[0]
    assert LAYOUTS["D"].bins[0].holds(inside)
    assert tidy.scene().held == "small_box_a"
    assert not tidy.is_success()
    driver.grip(-1.0)
    driver.move(over, np.pi / 2, -1.0)
    assert tidy.is_success()


def test_small_boxes_are_grasped_and_the_large_one_is_pushed(tidy: RobosuiteEnvironment) -> None:
    objects = {item.name: item for item in tidy.description.objects}
    graspable = {name for name, item in objects.items() if item.graspable}
    assert graspable == {"small_box_a", "small_box_b"}
    assert {name for name, item in objects.items() if item.pushable} == {"large_box"}
    assert objects["small_box_b"].yaw_symmetry == 4
    starts = tidy.description.affordances_for("push")
    assert {item.reference for item in starts} == {"large_box"}
    points = np.array([item.low for item in starts])
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 0.096, atol=1e-3)
    # No two neighbours are far apart: pushes start on all sides.
    assert np.max(np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)) < 0.04


def test_closed_fingers_push_the_large_box_and_do_not_hold_it(tidy: RobosuiteEnvironment) -> None:
    put(tidy, [-0.15, -0.13, 0.8231], [0.03, -0.13, 0.828], [-0.05, 0.03, 0.824])
    driver = Hand(tidy)
    start = tidy.description.affordances_for("push")[0]
    assert start.yaws is not None
    # Higher than the middle, so that the palm, which sticks out further, does not push.
    beside = tidy.scene().object_positions[2] + start.low + [0.0, 0.0, 0.01]
    driver.move([*beside[:2], 0.95], start.yaws[0], 1.0)
    driver.move(beside, start.yaws[0], 1.0)
    touched = False
    beyond = beside + np.array([0.15, 0.0, 0.0])
    for _ in range(40):
        driver.move(beyond, start.yaws[0], 1.0, steps=1)
        touched |= tidy._simulation.touches()[2] == (True, True)
        assert tidy.scene().held is None
    assert touched
    assert tidy.scene().object_positions[2, 0] > 0.05


def test_stepping_equals_stock_also_in_contact(
    tidy: RobosuiteEnvironment, stock: RobosuiteEnvironment
) -> None:
    put(tidy, BESIDE, IN_BIN[1], ON_MAT)
    for action in random_actions(10, seed=1):
        before = tidy.get_state()
        expected = last_state(stock, before, action[None])
        assert far_apart(last_state(tidy, before, action[None]), expected) <= 1e-9
    put(tidy, BESIDE, IN_BIN[1], ON_MAT)
    Hand(tidy).pick()
    held = tidy.get_state()
    actions = random_actions(100, seed=4) * 0.3
    actions[:, 4] = 1.0
    expected = last_state(stock, held, actions)
    assert stock.scene().held == "small_box_a"
    own = far_apart(last_state(tidy, held, actions)[:30], expected[:30])
    nudged = held.copy()
    nudged[1] += 1e-15  # the first joint; index 0 is the time
    chaos = far_apart(last_state(stock, nudged, actions)[:30], expected[:30])
    assert own <= 10 * chaos

"""CleanUp: what counts as cleaned up, and stepping."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import ArrayLike

from prime_core.checks import check_environment
from prime_envs_robosuite.config import CleanUpConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.tasks.clean_up import Variant, lies_on_top

from .conftest import Hand, far_apart, last_state, put, random_actions

SERVED = [-0.12, 0.20, 0.818]
ON_TOP = [-0.10, 0.21, 0.8519]
IN_BIN = [-0.05, -0.29, 0.8559]


def build(variant: Variant, stepping: str = "compiled") -> RobosuiteEnvironment:
    environment = CleanUpConfig(variant=variant, stepping=stepping).build()  # type: ignore[arg-type]
    assert isinstance(environment, RobosuiteEnvironment)
    return environment


@pytest.fixture(scope="module")
def into_bin() -> Iterator[RobosuiteEnvironment]:
    environment = build("bin")
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def onto_popcorn() -> Iterator[RobosuiteEnvironment]:
    environment = build("stack")
    yield environment
    environment.close()


@pytest.mark.parametrize("variant", ["bin", "stack"])
def test_each_variant_keeps_the_contract_and_asks_for_both_subtasks(variant: Variant) -> None:
    environment = build(variant)
    check_environment(environment)
    for seed in range(50):
        environment.reset(seed=seed)
        popcorn, butter = environment.scene().object_positions
        assert np.linalg.norm(popcorn[:2] - (-0.15, 0.15)) > 0.14
        assert np.linalg.norm(popcorn[:2] - butter[:2]) > 0.05
        assert not environment.is_success()


def test_popcorn_is_pushed_and_butter_is_grasped(onto_popcorn: RobosuiteEnvironment) -> None:
    popcorn, butter = onto_popcorn.description.objects
    assert (popcorn.pushable, popcorn.graspable) == (True, False)
    assert (butter.pushable, butter.graspable) == (False, True)
    places = onto_popcorn.description.affordances_for("place")
    assert [item.reference for item in places] == [None, "popcorn"]


@pytest.mark.parametrize(
    ("popcorn", "butter", "solved"),
    [
        (SERVED, IN_BIN, True),
        ([-0.05, 0.16, 0.818], IN_BIN, False),  # 0.1005 m from the serving area
        (SERVED, [-0.05, -0.15, 0.816], False),
        (SERVED, ON_TOP, False),
    ],
)
def test_butter_belongs_into_the_bin(
    popcorn: ArrayLike, butter: ArrayLike, solved: bool, into_bin: RobosuiteEnvironment
) -> None:
    put(into_bin, popcorn, butter)
    Hand(into_bin).grip(-1.0, 2)
    assert into_bin.is_success() is solved


@pytest.mark.parametrize(
    ("popcorn", "butter", "solved"),
    [
        (SERVED, ON_TOP, True),
        (SERVED, IN_BIN, False),
        ([0.03, 0.10, 0.818], [0.03, 0.10, 0.8519], False),
        (SERVED, [-0.12, 0.13, 0.816], False),  # leans on nothing, beside it
        (SERVED, [-0.12, 0.20, 0.87], False),  # in the air above it
    ],
)
def test_butter_belongs_on_top_of_the_popcorn(
    popcorn: ArrayLike, butter: ArrayLike, solved: bool, onto_popcorn: RobosuiteEnvironment
) -> None:
    put(onto_popcorn, popcorn, butter)
    assert onto_popcorn.is_success() is solved


def test_popcorn_that_still_slides_is_not_served(into_bin: RobosuiteEnvironment) -> None:
    put(into_bin, SERVED, IN_BIN, speed=0.06)
    assert not into_bin.is_success()


def test_on_top_goes_by_the_turned_box() -> None:
    assert lies_on_top(np.array([0.055, 0.0, 0.034]), 0.0)
    assert not lies_on_top(np.array([0.055, 0.0, 0.034]), np.pi / 2)
    assert lies_on_top(np.array([0.0, 0.055, 0.034]), np.pi / 2)


def test_butter_is_carried_onto_the_popcorn_and_counts_when_it_is_let_go_of(
    onto_popcorn: RobosuiteEnvironment,
) -> None:
    put(onto_popcorn, SERVED, [-0.08, -0.06, 0.816])
    driver = Hand(onto_popcorn)
    scene = onto_popcorn.scene()
    spot = scene.description.affordances_for("grasp")[0]
    butter = scene.object_positions[1]
    driver.move([*butter[:2], 0.95], 0.0, -1.0)
    driver.move(butter + spot.low, 0.0, -1.0)
    driver.grip(1.0)
    assert onto_popcorn.scene().held == "butter"
    driver.move([*butter[:2], 0.95], 0.0, 1.0)
    driver.move([*SERVED[:2], 0.95], 0.0, 1.0, 100)
    driver.move([*SERVED[:2], 0.854], 0.0, 1.0)
    assert onto_popcorn.scene().held == "butter"
    assert not onto_popcorn.is_success()
    driver.grip(-1.0)
    driver.move([*SERVED[:2], 0.95], 0.0, -1.0)
    assert onto_popcorn.is_success()


def test_stepping_equals_stock(into_bin: RobosuiteEnvironment) -> None:
    stock = build("bin", "stock")
    put(into_bin, SERVED, IN_BIN)
    for action in random_actions(5, seed=3):
        before = into_bin.get_state()
        expected = last_state(stock, before, action[None])
        assert far_apart(last_state(into_bin, before, action[None]), expected) <= 1e-9

"""What counts as solved, and what as held."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_envs_robosuite.config import PickPlaceConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.tasks.pick_place import in_quarter

MakeHand = Callable[[RobosuiteEnvironment], Any]


def test_lift_is_solved_with_the_cube_up_in_the_gripper(
    lift: RobosuiteEnvironment, hand: MakeHand
) -> None:
    lift.reset(seed=4)
    driver = hand(lift)
    assert not lift.is_success()
    driver.pick()
    assert lift.scene().held == "cube"
    assert lift.is_success()
    _, reward, terminated, _, info = lift.step(np.array([0, 0, 0, 0, 1.0]))
    assert (reward, terminated, info["is_success"]) == (1.0, True, True)


def test_a_cube_in_the_air_that_nothing_holds_is_not_lifted(lift: RobosuiteEnvironment) -> None:
    lift.reset(seed=4)
    joints = lift.scene().joint_positions
    lift.set_joint_state(np.array([*joints, 0.04, -0.04, 0.1, 0.1, 0.95, 1, 0, 0, 0]), np.zeros(15))
    assert lift.scene().object_positions[0, 2] > 0.84
    assert not lift.is_success()


def test_milk_is_solved_when_let_go_of_and_not_before(
    milk: RobosuiteEnvironment, hand: MakeHand, held_milk: NDArray[np.float64]
) -> None:
    milk.set_state(held_milk)
    driver = hand(milk)
    yaw = milk.scene().gripper_yaw
    spot = milk.description.affordances_for("place")[0].low
    driver.move([spot[0], spot[1], 1.05], yaw, 1.0, 100)
    assert milk.scene().held == "milk"  # stays held during transport
    driver.move([spot[0], spot[1], 0.935], yaw, 1.0)
    assert in_quarter(milk.scene().object_positions[0], 0)
    assert milk.scene().held == "milk"
    assert not milk.is_success()
    driver.grip(-1.0, 20)
    assert milk.scene().held is None
    driver.move([spot[0], spot[1], 1.05], yaw, -1.0)
    assert milk.is_success()


def test_milk_let_go_of_in_another_quarter_is_not_solved(
    milk: RobosuiteEnvironment, hand: MakeHand, held_milk: NDArray[np.float64]
) -> None:
    milk.set_state(held_milk)
    driver = hand(milk)
    x, y, height = milk.description.affordances_for("place")[2].low
    yaw = milk.scene().gripper_yaw
    driver.move([x, y, 1.05], yaw, 1.0, 100)
    driver.move([x, y, height], yaw, 1.0)
    driver.grip(-1.0, 20)
    assert milk.scene().held is None
    assert not milk.is_success()


@pytest.mark.parametrize("kind", ["can", "bread", "cereal"])
def test_each_grocery_can_be_grasped_where_its_affordance_says(kind: str, hand: MakeHand) -> None:
    environment = PickPlaceConfig(object=kind).build()  # type: ignore[arg-type]
    assert isinstance(environment, RobosuiteEnvironment)
    environment.reset(seed=1)
    driver = hand(environment)
    driver.grip(-1.0, 10)
    driver.pick()
    assert environment.scene().held == kind


def test_a_horizon_truncates(lift: RobosuiteEnvironment) -> None:
    lift.reset(seed=0)
    lift.horizon = 2
    try:
        assert [lift.step(np.zeros(5))[3] for _ in range(2)] == [False, True]
    finally:
        lift.horizon = None

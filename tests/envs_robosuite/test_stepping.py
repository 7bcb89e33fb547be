"""Compiled stepping against robosuite's own."""

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.errors import PrimeError
from prime_envs_robosuite.adapter import check_control_law
from prime_envs_robosuite.config import LiftConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment

from .conftest import far_apart, last_state, random_actions


def test_one_free_step_equals_stock_to_rounding(
    milk: RobosuiteEnvironment, stock_milk: RobosuiteEnvironment
) -> None:
    milk.reset(seed=1)
    for action in random_actions(25, seed=1):
        before = milk.get_state()
        expected = last_state(stock_milk, before, action[None])
        assert far_apart(last_state(milk, before, action[None]), expected) <= 1e-9
        assert milk.scene().held is None


def test_lift_takes_the_same_steps_as_stock(lift: RobosuiteEnvironment) -> None:
    stock = LiftConfig(stepping="stock").build()
    lift.reset(seed=2)
    state = lift.get_state()
    actions = random_actions(3, seed=2)
    assert far_apart(last_state(lift, state, actions), last_state(stock, state, actions)) <= 1e-9


def test_both_ways_reset_to_the_same_state(
    milk: RobosuiteEnvironment, stock_milk: RobosuiteEnvironment
) -> None:
    milk.reset(seed=3)
    stock_milk.reset(seed=3)
    np.testing.assert_array_equal(milk.get_state(), stock_milk.get_state())


def test_with_contact_it_diverges_no_more_than_stock_from_itself(
    milk: RobosuiteEnvironment, stock_milk: RobosuiteEnvironment, held_milk: NDArray[np.float64]
) -> None:
    actions = random_actions(100, seed=4) * 0.3
    actions[:, 4] = 1.0
    expected = last_state(stock_milk, held_milk, actions)
    own = far_apart(last_state(milk, held_milk, actions)[:30], expected[:30])
    nudged = held_milk.copy()
    nudged[1] += 1e-15  # the first joint; index 0 is the time
    chaos = far_apart(last_state(stock_milk, nudged, actions)[:30], expected[:30])
    assert stock_milk.scene().held == "milk"
    # These differ by a factor from run to run; a wrong control law is many decades above.
    assert own <= 10 * chaos


def test_two_threads_step_at_once_and_exactly(lift: RobosuiteEnvironment) -> None:
    from concurrent.futures import ThreadPoolExecutor

    other = LiftConfig().build()
    assert isinstance(other, RobosuiteEnvironment)
    lift.reset(seed=6)
    state = lift.get_state()
    actions = random_actions(20, seed=6)
    alone = last_state(lift, state, actions)
    with ThreadPoolExecutor(2) as pool:
        together = list(pool.map(lambda one: last_state(one, state, actions), (lift, other)))
    for result in together:
        np.testing.assert_array_equal(result, alone)


def test_a_robosuite_that_was_not_compared_is_refused() -> None:
    check_control_law("1.5.1")
    with pytest.raises(PrimeError, match=r"install robosuite==1\.5\.1 or set stepping: stock"):
        check_control_law("1.9.0")

"""States, resets and joint states."""

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.errors import PrimeError
from prime_envs_robosuite.config import PickPlaceConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment

State = NDArray[np.float64]


def run(environment: RobosuiteEnvironment, actions: State) -> list[State]:
    states = []
    for action in actions:
        environment.step(action)
        states.append(environment.get_state())
    return states


def test_a_restored_state_runs_the_same_to_the_bit_in_another_instance(
    milk: RobosuiteEnvironment, held_milk: State
) -> None:
    actions = np.random.default_rng(0).uniform(-0.03, 0.03, (15, 5))
    actions[:10, 4] = 1.0  # the gripper presses on the milk, then lets go
    actions[10:, 4] = -1.0
    milk.set_state(held_milk)
    straight = run(milk, actions)
    other = PickPlaceConfig().build()
    assert isinstance(other, RobosuiteEnvironment)
    other.reset(seed=99)
    for start in (0, 4, 12):
        other.set_state(straight[start])
        again = run(other, actions[start + 1 :])
        np.testing.assert_array_equal(again, straight[start + 1 :])


def test_stock_stepping_restores_to_the_bit_too(
    stock_milk: RobosuiteEnvironment, held_milk: State
) -> None:
    actions = np.random.default_rng(1).uniform(-0.03, 0.03, (4, 5))
    stock_milk.set_state(held_milk)
    straight = run(stock_milk, actions)
    stock_milk.reset(seed=98)
    stock_milk.set_state(straight[0])
    np.testing.assert_array_equal(run(stock_milk, actions[1:])[-1], straight[-1])


def test_looking_does_not_change_the_future(milk: RobosuiteEnvironment, held_milk: State) -> None:
    actions = np.random.default_rng(2).uniform(-0.03, 0.03, (5, 5))
    milk.set_state(held_milk)
    np.testing.assert_array_equal(milk.get_state(), held_milk)
    expected = run(milk, actions)[-1]
    milk.set_state(held_milk)
    for action in actions:
        milk.set_state(milk.get_state())
        milk.scene()
        milk.is_success()
        milk.step(action)
    np.testing.assert_array_equal(milk.get_state(), expected)


def test_the_scene_after_a_step_is_the_scene_of_its_state(
    milk: RobosuiteEnvironment, held_milk: State
) -> None:
    milk.set_state(held_milk)
    observation, *_ = milk.step(np.array([0.02, 0.02, 0.0, 0.1, 1.0]))
    milk.set_state(milk.get_state())
    for key, value in milk.scene().observation().items():
        np.testing.assert_array_equal(value, observation[key])


def test_the_same_seed_gives_the_same_start_whatever_happened_before(
    milk: RobosuiteEnvironment,
) -> None:
    milk.reset(seed=11)
    first = milk.get_state()
    following = []
    for _ in range(2):
        milk.reset()
        following.append(milk.get_state())
    np.random.seed(0)
    milk.step(np.ones(5))
    milk.reset(seed=11)
    np.testing.assert_array_equal(milk.get_state(), first)
    for expected in following:
        milk.reset()
        np.testing.assert_array_equal(milk.get_state(), expected)
    assert not np.array_equal(following[0], first)


def test_starts_vary_in_arm_and_object(lift: RobosuiteEnvironment) -> None:
    scenes = []
    for seed in range(20):
        lift.reset(seed=seed)
        scenes.append(lift.scene())
    cubes = np.array([scene.object_positions[0] for scene in scenes])
    joints = np.array([scene.joint_positions for scene in scenes])
    assert np.all(np.abs(cubes[:, :2]) <= 0.03)
    assert cubes[:, :2].std(axis=0).min() > 0.005
    np.testing.assert_allclose(joints.std(axis=0), 0.02, atol=0.015)


def test_a_state_of_another_size_is_refused(lift: RobosuiteEnvironment) -> None:
    size = lift.get_state().size
    with pytest.raises(PrimeError, match=rf"shape \({size},\), not \(3,\)"):
        lift.set_state(np.zeros(3))


def test_joints_can_be_set_and_stepped_from(lift: RobosuiteEnvironment) -> None:
    lift.reset(seed=1)
    positions = np.array([*lift.scene().joint_positions, 0.03, -0.03, 0.1, -0.1, 0.9, 1, 0, 0, 0])
    lift.set_joint_state(positions, np.zeros(15))
    scene = lift.scene()
    assert scene.gripper_opening == pytest.approx(0.06)
    np.testing.assert_array_equal(scene.object_positions[0], [0.1, -0.1, 0.9])
    before = scene.gripper_position
    lift.step(np.zeros(5))
    after = lift.scene()
    assert after.object_positions[0, 2] < 0.9  # it falls
    np.testing.assert_allclose(after.gripper_position, before, atol=0.005)
    assert after.gripper_opening == pytest.approx(0.06, abs=0.002)


def test_joints_of_another_model_are_refused(lift: RobosuiteEnvironment) -> None:
    with pytest.raises(PrimeError, match="has 16 positions and 15 velocities"):
        lift.set_joint_state(np.zeros(9), np.zeros(15))

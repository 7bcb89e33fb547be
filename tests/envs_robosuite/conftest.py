"""Environments that the tests of this folder share, and a hand that drives them."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.rotations import wrap_angle, yaw_of
from prime_envs_robosuite.config import LiftConfig, NutAssemblyConfig, PickPlaceConfig
from prime_envs_robosuite.demonstrators.styles import NOVICE, StyleRanges
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.recordings.robosuite_hdf5 import RobosuiteHdf5Config

from .hdf5_files import FRAMES, good, record

GAIN = 3.0  # the controller covers about a third of the commanded distance in a step
OPEN, CLOSE = -1.0, 1.0


class Hand:
    """Drives an environment's gripper to positions."""

    def __init__(self, environment: RobosuiteEnvironment) -> None:
        self.environment = environment

    def move(self, target: ArrayLike, yaw: float, gripper: float, steps: int = 60) -> None:
        """Servo the gripper to a position [m] and a yaw [rad, modulo pi]."""
        for _ in range(steps):
            scene = self.environment.scene()
            error = np.asarray(target) - scene.gripper_position
            turn = float(wrap_angle(yaw - scene.gripper_yaw, np.pi))
            if np.linalg.norm(error) < 0.004 and abs(turn) < 0.05:
                return
            action = np.array([*(GAIN * error), GAIN * turn, gripper])
            self.environment.step(np.clip(action, -ACTION_LIMIT, ACTION_LIMIT))

    def grip(self, gripper: float, steps: int = 12) -> None:
        """Open or close the gripper where it is."""
        for _ in range(steps):
            self.environment.step(np.array([0.0, 0.0, 0.0, 0.0, gripper]))

    def pick(self) -> None:
        """Grasp the first object that can be grasped, where its affordance says, and lift it."""
        scene = self.environment.scene()
        spot = scene.description.affordances_for("grasp")[0]
        assert spot.reference is not None, "an object is grasped, not the world"
        index = scene.object_index(spot.reference)
        own_yaw = float(yaw_of(scene.object_quaternions[index]))
        forward, aside, height = np.mean((spot.low, spot.high), axis=0)
        direction = np.exp(1j * own_yaw) * (forward + 1j * aside)
        target = scene.object_positions[index] + [direction.real, direction.imag, height]
        yaw = own_yaw + (spot.yaws or (0.0,))[0]
        lift = scene.description.lift_height
        self.move([target[0], target[1], lift], yaw, OPEN, 80)
        self.move(target, yaw, OPEN)
        self.grip(CLOSE)
        self.move([target[0], target[1], lift], yaw, CLOSE)


def settled(environment: RobosuiteEnvironment, seed: int) -> RobosuiteEnvironment:
    """Reset, and let what was dropped come to rest."""
    environment.reset(seed=seed)
    Hand(environment).grip(OPEN, 10)
    return environment


def random_actions(count: int, seed: int) -> NDArray[np.float64]:
    """Return motor actions ``(count, 5)`` within their limits."""
    return np.random.default_rng(seed).uniform(-ACTION_LIMIT, ACTION_LIMIT, (count, 5))


def last_state(
    environment: RobosuiteEnvironment, state: NDArray[np.float64], actions: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the state that actions lead to."""
    environment.set_state(state)
    for action in actions:
        environment.step(action)
    return environment.get_state()


def novice_but(**changed: Any) -> StyleRanges:
    """Return the novice's style with other ranges, checked as settings are."""
    return StyleRanges.model_validate(NOVICE.model_dump() | changed)


def put(environment: RobosuiteEnvironment, *positions: ArrayLike, speed: float = 0.0) -> None:
    """Put each object somewhere [m] at yaw 0; the first one moves along x [m/s]."""
    environment.reset(seed=0)
    scene = environment.scene()
    objects = [[*np.asarray(position), 1.0, 0.0, 0.0, 0.0] for position in positions]
    joints = np.concatenate([scene.joint_positions, [0.04, -0.04], *objects])
    velocities = np.zeros(9 + 6 * len(objects))
    velocities[9] = speed
    environment.set_joint_state(joints, velocities)


def far_apart(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Return the greatest difference of two states."""
    return float(np.abs(first - second).max())


@pytest.fixture(scope="session")
def hand() -> Callable[[RobosuiteEnvironment], Hand]:
    return Hand


@pytest.fixture(scope="session")
def lift() -> Iterator[RobosuiteEnvironment]:
    environment = LiftConfig().build()
    assert isinstance(environment, RobosuiteEnvironment)
    yield environment
    environment.close()


@pytest.fixture(scope="session")
def milk() -> Iterator[RobosuiteEnvironment]:
    environment = PickPlaceConfig().build()
    assert isinstance(environment, RobosuiteEnvironment)
    yield environment
    environment.close()


@pytest.fixture(scope="session")
def nut() -> Iterator[RobosuiteEnvironment]:
    environment = NutAssemblyConfig().build()
    assert isinstance(environment, RobosuiteEnvironment)
    yield environment
    environment.close()


@pytest.fixture(scope="session")
def stock_milk() -> Iterator[RobosuiteEnvironment]:
    environment = PickPlaceConfig(stepping="stock").build()
    assert isinstance(environment, RobosuiteEnvironment)
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def held_milk(milk: RobosuiteEnvironment) -> NDArray[np.float64]:
    """The state of an environment that has picked the milk up."""
    settled(milk, 5)
    Hand(milk).pick()
    assert milk.scene().held == "milk"
    return milk.get_state()


@pytest.fixture(scope="module")
def states(lift: RobosuiteEnvironment) -> Any:
    """Time, qpos and qvel of a gripper that goes down, ``(FRAMES, 32)``."""
    lift.reset(seed=0)
    rows = [lift.get_state()[:32]]
    for _ in range(FRAMES - 1):
        lift.step(np.array([0.0, 0.0, -0.03, 0.0, -1.0]))
        rows.append(lift.get_state()[:32])
    found = np.stack(rows)
    found[:, 0] = 0.05 * np.arange(FRAMES)
    return found


@pytest.fixture(scope="module")
def shown(states: Any, tmp_path_factory: pytest.TempPathFactory) -> Demonstration:
    """What is read of them."""
    path = record(tmp_path_factory.mktemp("a") / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    return RobosuiteHdf5Config(path=path).demonstrate(LiftConfig(), 0, 0)

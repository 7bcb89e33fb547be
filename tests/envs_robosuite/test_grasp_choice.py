"""Where the simulated teleoperator grasps: where the hand has room."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from prime_core.contracts.scene import Scene
from prime_core.errors import PrimeError
from prime_core.rotations import wrap_angle
from prime_envs_robosuite.config import LiftConfig, TidyUpConfig
from prime_envs_robosuite.demonstrators import picking
from prime_envs_robosuite.demonstrators.grasp_choice import choose_grasp
from prime_envs_robosuite.demonstrators.simulated_teleoperator import SimulatedTeleoperatorConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.tasks.subtasks import PutInto
from prime_envs_robosuite.tasks.table_top_objects import BIN_HEIGHT, TABLE_TOP

from .conftest import novice_but

SMALL, OTHER, LARGE = 0, 1, 2
AWAY = np.array([[-0.12, 0.0], [0.1, 0.2], [0.1, 0.0]])  # x and y of each box [m]


@pytest.fixture(scope="module")
def tidy_up() -> Iterator[RobosuiteEnvironment]:
    built = TidyUpConfig().build()
    assert isinstance(built, RobosuiteEnvironment)
    built.reset(seed=0)
    yield built
    built.close()


def put(scene: Scene, places: np.ndarray, yaws: tuple[float, float, float]) -> Scene:
    """Return a scene with the boxes elsewhere, standing, turned by yaws [rad]."""
    half = np.array(yaws) / 2
    nothing = np.zeros(3)
    quaternions = np.stack((np.cos(half), nothing, nothing, np.sin(half)), axis=1)
    positions = np.column_stack((places, scene.object_positions[:, 2]))
    objects = replace(scene.known_objects, positions=positions, quaternions=quaternions)
    return replace(scene, objects=objects)


def subtask_of(environment: RobosuiteEnvironment, name: str) -> PutInto:
    (subtask,) = [item for item in environment.task.subtasks() if item.object_name == name]
    assert isinstance(subtask, PutInto)
    return subtask


def grasps(environment: RobosuiteEnvironment, scene: Scene, name: str) -> np.ndarray:
    """Return the yaws of many grasps of an object [rad], ``(30,)``."""
    draws = np.random.default_rng(0)
    subtask = subtask_of(environment, name)
    return np.array([choose_grasp(scene, subtask, draws)[1] for _ in range(30)])


def test_alone_a_box_is_gripped_across_either_side(tidy_up: RobosuiteEnvironment) -> None:
    scene = put(tidy_up.scene(), AWAY, (0.3, 0.0, 0.0))
    turns = np.abs(wrap_angle(grasps(tidy_up, scene, "small_box_a") - 0.3, np.pi / 2))
    assert turns.max() < 0.11


def test_beside_another_box_the_hand_goes_where_it_has_room(tidy_up: RobosuiteEnvironment) -> None:
    places = AWAY.copy()
    # Along the small box's y axis: no room for a finger there, but for the hand's thin side.
    places[LARGE] = places[SMALL] + 0.1 * np.array([-np.sin(0.3), np.cos(0.3)])
    scene = put(tidy_up.scene(), places, (0.3, 0.0, 0.3))
    yaws = grasps(tidy_up, scene, "small_box_a")
    assert np.abs(wrap_angle(yaws - 0.3 - np.pi / 2, np.pi)).max() < 0.11


def test_beside_a_wall_a_box_is_gripped_at_its_corners(tidy_up: RobosuiteEnvironment) -> None:
    places = AWAY.copy()
    places[OTHER] = [-0.09, -0.15]  # 7 cm from the bin's wall, which is higher than the hand
    assert tidy_up.scene().object_positions[OTHER, 2] < TABLE_TOP + BIN_HEIGHT
    scene = put(tidy_up.scene(), places, (0.0, np.pi / 4, 0.0))
    yaws = grasps(tidy_up, scene, "small_box_b")
    # Neither of its own yaws, 45 degrees, has room.
    assert np.abs(wrap_angle(yaws - np.pi / 4, np.pi / 2)).min() > 0.15
    assert np.abs(yaws).min() > 0.9


def test_who_looks_again_is_nearer_when_the_gripper_closes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chosen: list[np.ndarray] = []

    def noted(*arguments: Any) -> tuple[np.ndarray, float]:
        position, yaw = choose_grasp(*arguments)
        chosen.append(position)
        return position, yaw

    monkeypatch.setattr(picking, "choose_grasp", noted)

    def misses(grip_within: float | None) -> list[float]:
        # Clumsy enough that it matters whether they look again.
        style = novice_but(miss_share=0.0, flow=(1, 1), aim=(0.02, 0.02))
        demonstrator = SimulatedTeleoperatorConfig(grip_within=grip_within, style=style)
        found = []
        for index in range(6):
            chosen.clear()
            shown = demonstrator.demonstrate(LiftConfig(), index, 0)
            closing = int(np.flatnonzero(shown.actions[:, 4] > 0)[0])
            position = shown.observations.gripper_position[closing]
            found.append(min(float(np.linalg.norm(position - item)) for item in chosen))
        return found

    assert max(misses(0.004)) < 0.0045
    assert max(misses(None)) > 0.006


def test_who_cannot_be_exact_enough_gives_up() -> None:
    demonstrator = SimulatedTeleoperatorConfig(grip_within=1e-5, attempts=2)
    with pytest.raises(PrimeError, match="no demonstration 0 of seed 0 succeeded in 2 attempts"):
        demonstrator.demonstrate(LiftConfig(), 0, 0)

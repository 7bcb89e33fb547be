"""Subtasks that no environment of the pack asks for yet, and several in a row."""

from collections.abc import Iterator

import numpy as np
import pytest

from prime_core.contracts.scene import Scene
from prime_envs_robosuite.demonstrators.simulated_teleoperator import SimulatedTeleoperatorConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.tasks.lift import CUBE_HALF_SIZE, TABLE_TOP, LiftTask
from prime_envs_robosuite.tasks.subtasks import (
    ArmReach,
    HoldUp,
    Push,
    PutInto,
    PutOnto,
    Subtask,
    in_opposite_order,
)

from .conftest import novice_but

ANYWHERE = ArmReach(base=(-0.56, 0.0), distance=0.78)
LYING = TABLE_TOP + CUBE_HALF_SIZE
PUSH = Push(
    object_name="cube",
    low=(-0.02, 0.12),
    high=(0.02, 0.16),
    standoff=0.07,
    touching=0.035,
    height=LYING,
)
PUT = PutInto(object_name="cube", low=(-0.15, -0.2), high=(-0.1, -0.15), reach=ANYWHERE)
NOVICES = SimulatedTeleoperatorConfig()
FLUENT = SimulatedTeleoperatorConfig(
    style=novice_but(ramp=(0.3, 0.3), turn_speed=(1.5, 1.5), flow=(1.0, 1.0), miss_share=0.0)
)


@pytest.fixture(scope="module")
def table() -> Iterator[RobosuiteEnvironment]:
    environment = RobosuiteEnvironment(LiftTask())
    yield environment
    environment.close()


def perform(
    environment: RobosuiteEnvironment,
    subtasks: tuple[Subtask, ...],
    seed: int,
    demonstrator: SimulatedTeleoperatorConfig = NOVICES,
) -> list[Scene]:
    """Let the teleoperator do subtasks; return the scenes that it saw."""
    environment.reset(seed=seed)
    generator = np.random.default_rng(seed)
    operator = demonstrator.draw_operator(subtasks, environment.scene(), generator)
    scenes = [environment.scene()]
    doing = operator.perform(scenes[0])
    action = next(doing, None)
    while action is not None:
        environment.step(action)
        scenes.append(environment.scene())
        try:
            action = doing.send(scenes[-1])
        except StopIteration:
            action = None
    return scenes


def cube(scene: Scene) -> list[float]:
    return [float(value) for value in scene.object_positions[0]]


def test_what_pushes_keeps_its_place_in_the_opposite_order() -> None:
    other = HoldUp(object_name="cube")
    assert in_opposite_order((PUT, other, PUSH)) == (other, PUT, PUSH)
    assert in_opposite_order((PUSH, PUT)) == (PUSH, PUT)


@pytest.mark.parametrize("seed", range(4))
def test_a_cube_is_pushed_over_the_table(table: RobosuiteEnvironment, seed: int) -> None:
    scenes = perform(table, (PUSH,), seed)
    x, y, z = cube(scenes[-1])
    assert -0.02 - 0.015 <= x <= 0.02 + 0.015
    assert 0.12 - 0.015 <= y <= 0.16 + 0.015
    assert max(cube(scene)[2] for scene in scenes[20:]) < LYING + 0.005  # never taken
    assert z == pytest.approx(LYING, abs=2e-3)
    assert scenes[-1].gripper_position[2] > TABLE_TOP + 0.1
    pushing = [scene for scene in scenes if scene.gripper_position[2] < TABLE_TOP + 0.05]
    assert max(scene.gripper_opening for scene in pushing) < 0.01


@pytest.mark.parametrize("seed", range(2))
def test_subtasks_are_done_one_after_another(table: RobosuiteEnvironment, seed: int) -> None:
    onto = PutOnto(
        object_name="cube",
        point=(0.05, 0.05, LYING),
        reach=ANYWHERE,
        clearance=0.08,
        drop=(0.001, 0.004),
        retreat=(0.06, 0.1),
    )
    scenes = perform(table, (PUSH, PUT, onto, HoldUp(object_name="cube")), seed)
    path = np.array([cube(scene) for scene in scenes])
    still = [
        np.flatnonzero(np.linalg.norm(path[:, :2] - spot, axis=1) < 0.04)
        for spot in ((0.0, 0.14), (-0.125, -0.175), (0.05, 0.05))
    ]
    assert still[0][0] < still[1][0] < still[2][0]
    assert scenes[-1].held == "cube"
    assert path[-1, 2] > LYING + 0.05


def test_an_object_is_put_where_its_centre_should_be(table: RobosuiteEnvironment) -> None:
    onto = PutOnto(
        object_name="cube",
        point=(0.05, 0.05, LYING),
        reach=ANYWHERE,
        clearance=0.08,
        drop=(0.001, 0.004),
        retreat=(0.06, 0.1),
    )
    for seed in range(2):
        scene = perform(table, (onto,), seed)[-1]
        assert np.allclose(cube(scene), [0.05, 0.05, LYING], atol=0.01)
        assert scene.held is None


def test_the_fluent_lift_and_carry_without_a_stop(table: RobosuiteEnvironment) -> None:
    slowest = {}
    for demonstrator in (NOVICES, FLUENT):
        scenes = perform(table, (PUT,), 1, demonstrator)
        carried = np.array([scene.gripper_position for scene in scenes if scene.held == "cube"])
        far = np.linalg.norm(carried[:, :2] - carried[0, :2], axis=1)
        lifted = carried[:, 2] > carried[0, 2] + 0.03
        on_the_way = carried[lifted & (far < 0.8 * far[-1])]
        speeds = np.linalg.norm(np.diff(on_the_way, axis=0), axis=1)
        slowest[demonstrator is FLUENT] = speeds.min()
        assert cube(scenes[-1])[2] == pytest.approx(LYING, abs=2e-3)
    assert slowest[False] < 0.001  # 2 cm/s
    assert slowest[True] > 0.004


def test_the_fluent_go_from_one_subtask_to_the_next_and_are_done_sooner(
    table: RobosuiteEnvironment,
) -> None:
    steps = {}
    for demonstrator in (NOVICES, FLUENT):
        scenes = perform(table, (PUSH, PUT), 0, demonstrator)
        steps[demonstrator is FLUENT] = len(scenes)
        assert scenes[-1].held is None
        assert np.allclose(cube(scenes[-1])[:2], [-0.125, -0.175], atol=0.05)
    assert steps[True] < 0.75 * steps[False]

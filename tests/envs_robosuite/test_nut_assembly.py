"""NutAssembly: its first states, its physics, and when it is solved."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

from prime_core.checks import check_environment
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.scene import Scene
from prime_core.rotations import rotation_matrix, yaw_of
from prime_envs_robosuite.config import NutAssemblyConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.tasks.nut_assembly import PEG_TOP, SHAPES

MakeHand = Callable[[RobosuiteEnvironment], Any]
PEG = np.array(SHAPES["round"].peg)


def build(**settings: Any) -> RobosuiteEnvironment:
    environment = NutAssemblyConfig(**settings).build()
    assert isinstance(environment, RobosuiteEnvironment)
    return environment


def first_scenes(environment: RobosuiteEnvironment, count: int = 40) -> list[Scene]:
    scenes = []
    for seed in range(count):
        environment.reset(seed=seed)
        scenes.append(environment.scene())
    return scenes


def handles(scenes: list[Scene]) -> NDArray[np.float64]:
    """Return where the handles are held [m], ``(N, 3)``."""
    spot = scenes[0].description.affordances_for("grasp")[0].low
    turns = [rotation_matrix(scene.object_quaternions[0]) for scene in scenes]
    return np.array(
        [scene.object_positions[0] + turn @ spot for scene, turn in zip(scenes, turns, strict=True)]
    )


def test_it_keeps_the_contract(nut: RobosuiteEnvironment) -> None:
    check_environment(nut, other=build())


@pytest.mark.parametrize("kind", ["round", "square"])
def test_the_paper_starts_with_the_handle_on_the_robots_side(kind: str) -> None:
    environment = build(nut=kind)
    scenes = first_scenes(environment)
    centres = np.array([scene.object_positions[0] for scene in scenes])
    side = np.sign(SHAPES[kind].peg[1])
    assert np.all((centres[:, 0] > -0.116) & (centres[:, 0] < -0.109))
    assert np.all((side * centres[:, 1] > 0.109) & (side * centres[:, 1] < 0.226))
    assert np.all(handles(scenes)[:, 0] <= centres[:, 0])
    description = environment.description
    for point in [*handles(scenes), [*SHAPES[kind].peg, PEG_TOP]]:
        assert np.all(np.array(description.workspace_low[:2]) <= point[:2])
        assert np.all(np.array(description.workspace_high[:2]) >= point[:2])


def test_robosuite_starts_at_any_yaw() -> None:
    scenes = first_scenes(build(initial_range="robosuite"))
    yaws = np.array([yaw_of(scene.object_quaternions[0]) for scene in scenes])
    assert 10 <= np.sum(np.abs(yaws) < np.pi / 2) <= 30


def test_the_other_nut_is_left_out_and_both_pegs_stay(nut: RobosuiteEnvironment) -> None:
    model = nut._simulation.model
    names = {model.body(index).name for index in range(model.nbody)}
    assert {"RoundNut_main", "peg1", "peg2"} <= names
    assert not any(name.startswith("SquareNut") for name in names)
    robot = nut.description.robot
    assert robot is not None
    assert robot.furniture_geoms == ("table_0", "peg1_0", "peg2_0")


@pytest.mark.parametrize("kind", ["round", "square"])
def test_one_step_equals_stock_to_rounding(kind: str) -> None:
    compiled, stock = build(nut=kind), build(nut=kind, stepping="stock")
    compiled.reset(seed=1)
    stock.reset(seed=1)
    np.testing.assert_array_equal(compiled.get_state(), stock.get_state())
    actions = np.random.default_rng(1).uniform(-ACTION_LIMIT, ACTION_LIMIT, (10, 5))
    for action in actions:
        stock.set_state(compiled.get_state())
        stock.step(action)
        compiled.step(action)
        assert np.abs(compiled.get_state() - stock.get_state()).max() <= 1e-9


def test_it_is_solved_when_let_go_of_and_not_before(
    nut: RobosuiteEnvironment, hand: MakeHand
) -> None:
    nut.reset(seed=2)
    driver = hand(nut)
    driver.grip(-1.0, 10)
    driver.pick()
    assert nut.scene().held == "nut"
    yaw = nut.scene().gripper_yaw

    def bring(height: float) -> None:
        scene = nut.scene()
        away = scene.gripper_position - scene.object_positions[0]
        driver.move([*(PEG + away[:2]), height], yaw, 1.0, 100)

    bring(1.0)
    bring(1.0)
    bring(0.85)
    assert nut.scene().held == "nut"
    assert np.abs(nut.scene().object_positions[0, :2] - PEG).max() < 0.012
    assert not nut.is_success()  # around the peg, but held
    driver.grip(-1.0, 25)
    assert nut.is_success()
    driver.grip(1.0, 12)
    assert not nut.is_success()


def test_a_nut_on_top_of_the_peg_or_beside_it_is_not_solved(nut: RobosuiteEnvironment) -> None:
    nut.reset(seed=3)
    joints = nut.scene().joint_positions
    for x, y, z, expected in [
        (*PEG, 0.83, True),
        (*PEG, PEG_TOP + 0.02, False),
        (PEG[0] - 0.08, PEG[1], 0.83, False),
        (*SHAPES["square"].peg, 0.83, False),
    ]:
        positions = np.array([*joints, 0.04, -0.04, x, y, z, 0.0, 0.0, 0.0, 1.0])
        nut.set_joint_state(positions, np.zeros(15), -1.0)
        assert nut.is_success() is expected


def test_a_moving_nut_is_not_solved(nut: RobosuiteEnvironment) -> None:
    nut.reset(seed=3)
    positions = [*nut.scene().joint_positions, 0.04, -0.04, *PEG, 0.86, 0.0, 0.0, 0.0, 1.0]
    velocities = np.zeros(15)
    velocities[-4] = -0.3
    nut.set_joint_state(np.array(positions), velocities, -1.0)
    assert not nut.is_success()


def test_other_nuts_and_ranges_are_refused() -> None:
    with pytest.raises(ValidationError, match="Input should be 'round', 'square' or 'both'"):
        NutAssemblyConfig(nut="hexagonal")  # type: ignore[arg-type]
    with pytest.raises(ValidationError, match="Input should be 'paper' or 'robosuite'"):
        NutAssemblyConfig(initial_range="anywhere")  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["round", "square"])
def test_the_nut_lies_on_the_table_at_the_start(kind: str) -> None:
    environment = build(nut=kind)
    for seed in range(10):
        environment.reset(seed=seed)
        before = environment.scene().object_positions[0]
        for _ in range(8):
            environment.step(np.zeros(5))
        assert np.allclose(environment.scene().object_positions[0], before, atol=0.001)
    environment.close()

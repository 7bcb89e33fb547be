"""Push: its criteria, its prior, and objects that really move."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from prime_core.checks import check_primitive
from prime_core.contracts.description import Affordance
from prime_core.contracts.environment import Environment
from prime_core.contracts.scene import Scene
from prime_core.execution.motions import run_primitive, settle
from prime_envs_robosuite.config import LiftConfig
from prime_primitives_scripted.push import Push, PushConfig

from .floating_gripper import DESCRIPTION, block_moved, held_now, scene_at

SIDES = tuple(
    Affordance("push", "block", point, point, None)
    for point in ((0.06, 0.0, 0.0), (-0.06, 0.0, 0.0), (0.0, 0.06, 0.0), (0.0, -0.06, 0.0))
)
BLOCK, ANVIL = DESCRIPTION.objects
WITH_PUSH = replace(
    DESCRIPTION,
    objects=(replace(BLOCK, pushable=True), ANVIL),
    affordances=(*DESCRIPTION.affordances, *SIDES),
)
CALL = np.array([0.0, -0.1, 0.82, 0.3, 0.2, 0.0, 0.0])
push = PushConfig().build(WITH_PUSH)


def world_scene(position: np.ndarray, block: tuple[float, float], held: str | None = None) -> Scene:
    """Return a scene with the gripper and the block somewhere [m]."""
    scene = replace(scene_at(position, yaw=0.3, held=held), description=WITH_PUSH)
    return block_moved(scene, np.append(block, 0.82) - scene.object_positions[0])


def run(block_end: tuple[float, float], end: float = 0.2, start: float = 0.0) -> list[Scene]:
    """Return scenes: before, at the push's start, at its end, and a step later, all still."""
    last = world_scene(CALL[:3] + np.array([end, 0.0, 0.0]), block_end)
    return [
        world_scene(np.array([0.0, 0.0, 1.0]), (0.1, -0.1)),
        world_scene(CALL[:3] + np.array([start, 0.0, 0.0]), (0.1, -0.1)),
        last,
        last,
    ]


def test_it_starts_with_an_empty_gripper_only() -> None:
    assert push.can_start(world_scene(CALL[:3], (0.1, -0.1)))
    assert not push.can_start(world_scene(CALL[:3], (0.1, -0.1), held="block"))


def test_it_counts_where_both_ends_were_reached_and_the_object_moved_along() -> None:
    assert push.succeeded(run((0.25, -0.1)), CALL)
    assert push.succeeded(run((0.25, -0.1), end=0.214, start=0.014), CALL)
    assert not push.succeeded(run((0.25, -0.1), end=0.184), CALL)
    assert not push.succeeded(run((0.25, -0.1), start=0.016), CALL)
    assert not push.succeeded(run((0.169, -0.1)), CALL)
    assert not push.succeeded(run((0.1, 0.05)), CALL)


def test_what_still_slides_or_went_farther_than_the_hand_does_not_count() -> None:
    *before, after = run((0.25, -0.1))
    assert push.succeeded([*before, block_moved(after, [0.0005, 0.0, 0.0])], CALL)
    assert not push.succeeded([*before, block_moved(after, [0.002, 0.0, 0.0])], CALL)
    assert push.succeeded(run((0.31, -0.1)), CALL)
    assert not push.succeeded(run((0.32, -0.1)), CALL)


def test_what_was_moved_on_the_way_to_the_start_does_not_count() -> None:
    scenes = run((0.25, -0.1))
    scenes[1] = block_moved(scenes[1], [0.02, 0.0, 0.0])
    assert not push.succeeded(scenes, CALL)


def test_what_may_not_be_pushed_does_not_count() -> None:
    other = PushConfig().build(DESCRIPTION)
    scenes = [replace(scene, description=DESCRIPTION) for scene in run((0.25, -0.1))]
    assert not other.succeeded(scenes, CALL)


def test_what_is_taken_along_in_the_fingers_does_not_count() -> None:
    *before, after = run((0.25, -0.1))
    assert not push.succeeded([*before, held_now(after, "block")], CALL)


def test_the_prior_goes_from_beside_an_object_through_it() -> None:
    generator = np.random.default_rng(0)
    scene = world_scene(np.array([0.0, 0.0, 1.0]), (0.05, -0.05))
    drawn = np.array([push.propose(scene, generator) for _ in range(200)])
    assert all(push.parameter_space.contains(values) for values in drawn)
    ends = drawn[:, :3] + drawn[:, 4:]
    assert np.all(ends >= np.array(WITH_PUSH.workspace_low) - 1e-9)
    assert np.all(ends <= np.array(WITH_PUSH.workspace_high) + 1e-9)
    away = np.array([0.05, -0.05]) - drawn[:, :2]
    cosines = np.sum(away * drawn[:, 4:6], axis=1)
    cosines /= np.linalg.norm(away, axis=1) * np.linalg.norm(drawn[:, 4:6], axis=1)
    assert np.median(np.arccos(np.clip(cosines, -1, 1))) < 0.4


def test_at_the_edge_the_prior_keeps_its_direction_and_leaves_out_what_has_no_room() -> None:
    generator = np.random.default_rng(0)
    scene = world_scene(np.array([0.0, 0.0, 1.0]), (0.2, 0.0))
    drawn = np.array([push.propose(scene, generator) for _ in range(200)])
    ends = drawn[:, :2] + drawn[:, 4:6]
    assert np.all(np.abs(ends) <= 0.3 + 1e-9)
    assert np.linalg.norm(drawn[:, 4:6], axis=1).min() >= PushConfig().length[0] - 1e-9
    away = np.array([0.2, 0.0]) - drawn[:, :2]
    turns = np.arctan2(drawn[:, 5], drawn[:, 4]) - np.arctan2(away[:, 1], away[:, 0])
    assert np.std(np.arctan2(np.sin(turns), np.cos(turns))) < 0.25


def test_where_no_push_has_room_the_arm_cannot_do_what_is_drawn() -> None:
    scene = world_scene(np.array([0.0, 0.0, 1.0]), (0.29, 0.0))
    only_outwards = replace(WITH_PUSH, affordances=SIDES[1:2])
    primitive = PushConfig().build(only_outwards)
    drawn = primitive.propose(replace(scene, description=only_outwards), np.random.default_rng(0))
    assert not primitive.reachable(scene, drawn)


def test_without_anything_to_push_the_prior_is_uniform() -> None:
    generator = np.random.default_rng(0)
    other = PushConfig().build(DESCRIPTION)
    scene = scene_at()
    drawn = np.array([other.propose(scene, generator) for _ in range(100)])
    assert np.std(drawn[:, 4]) > 0.15


@pytest.fixture(scope="module")
def table() -> Iterator[Environment]:
    """Lift with a cube that may be pushed."""
    environment = LiftConfig().build()
    cube = environment.description.objects[0]
    sides = tuple(replace(item, reference="cube") for item in SIDES)
    environment.description = replace(
        environment.description,
        objects=(replace(cube, pushable=True),),
        affordances=(*environment.description.affordances, *sides),
    )
    yield environment
    environment.close()


def build(environment: Environment) -> Push:
    return PushConfig().build(environment.description)


def test_it_keeps_the_contract(table: Environment) -> None:
    check_primitive(build(table), table)


def test_a_cube_is_pushed_along(table: Environment) -> None:
    primitive, generator = build(table), np.random.default_rng(1)
    succeeded = tried = 0
    for seed in range(10):
        table.reset(seed=seed)
        settle(table)
        scene = table.scene()
        draws = (primitive.propose(scene, generator) for _ in range(50))
        drawn = next(values for values in draws if primitive.reachable(scene, values))
        execution = run_primitive(table, primitive, drawn)
        tried += 1
        succeeded += primitive.succeeded(execution.scenes, drawn)
    assert succeeded >= 0.5 * tried


def test_a_setting_without_sense_is_refused() -> None:
    with pytest.raises(ValidationError, match=r"0 <= low <= high; found \[0.4, 0.14\]"):
        PushConfig(length=(0.4, 0.14))
    with pytest.raises(ValidationError, match="greater than or equal to 0"):
        PushConfig(position_std=(-0.01, 0.0, 0.0))
    with pytest.raises(ValidationError, match="greater than or equal to 0"):
        PushConfig(yaw_std=-0.1)


def test_a_push_with_an_end_outside_of_the_workspace_is_refused() -> None:
    outside = CALL.copy()
    outside[5] = -0.3
    assert push.reachable(scene_at(CALL[:3]), CALL)
    assert not push.reachable(scene_at(CALL[:3]), outside)

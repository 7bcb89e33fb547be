"""Primitives in robosuite's physics."""

import numpy as np
import pytest

from prime_core.checks import check_primitive
from prime_core.collection.episode import Collector
from prime_core.collection.settings import CollectionConfig
from prime_core.contracts.environment import Environment
from prime_core.contracts.observations import Observations
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene
from prime_core.execution.motions import run_actions, settle
from prime_core.execution.world import World as CollectionWorld
from prime_envs_robosuite.config import TidyUpConfig
from prime_primitives_scripted.grasp import GraspConfig
from prime_primitives_scripted.place import PlaceConfig
from prime_primitives_scripted.reach import ReachConfig

from .conftest import World


def errors(world: World, primitive: Primitive, seeds: range) -> tuple[list[bool], np.ndarray]:
    """Run reachable uniform draws; return successes and errors [m] at the end."""
    generator = np.random.default_rng(seeds.start)
    successes, distances = [], []
    for seed in seeds:
        world.reset(seed)
        drawn = world.draw(primitive, generator, uniform=True)
        succeeded, execution = world.run(primitive, drawn)
        successes.append(succeeded)
        end = execution.scenes[-1].gripper_position
        distances.append(np.linalg.norm(end - drawn[:3]))
        assert max(scene.gripper_position[2] for scene in execution.scenes) < 1.10
    return successes, np.array(distances)


def test_uniform_reaches_end_where_they_should(world: World) -> None:
    successes, distances = errors(world, world.reach, range(12))
    assert np.mean(successes) >= 0.9
    assert np.median(distances) < 0.002


def test_a_far_reach_then_a_near_one(world: World) -> None:
    low, high = world.reach.parameter_space.low, world.reach.parameter_space.high
    scene = world.environment.scene()
    for side in (low, high):
        world.reset(3)
        scene = world.environment.scene()
        corner = np.array([high[0], side[1], 0.5 * (low[2] + high[2]), 0.0])
        near = np.append(scene.gripper_position, 0.0).clip(low, high)
        near[2] = scene.description.lift_height
        # The farthest point towards the corner that is not refused.
        ways = np.linspace(1.0, 0.0, 40)[:, None] * (corner - near) + near
        far = next(point for point in ways if world.reach.reachable(scene, point))
        assert world.run(world.reach, far)[0]
        assert world.reach.reachable(world.environment.scene(), near)
        assert world.run(world.reach, near)[0]


def test_an_arm_whose_elbow_is_locked_starts_nothing(milk: World) -> None:
    milk.reset(0)
    assert milk.reach.can_start(milk.environment.scene())
    away = np.array([0.05, 0.05, 0.0, 0.0, -1.0])  # to where the arm ends
    run_actions(milk.environment, np.tile(away, (120, 1)))
    stretched = milk.environment.scene()
    assert not any(item.can_start(stretched) for item in (milk.reach, milk.grasp))


def test_motor_actions_that_lock_the_arm_are_not_recorded(milk: World) -> None:
    environment = milk.environment
    config = CollectionConfig(draws_per_episode=40, atomic_share=1.0, atomic_steps=(60, 60))
    collector = Collector(CollectionWorld(environment, (milk.reach, milk.grasp)), config)
    episode, _ = collector.collect(np.random.default_rng(0))
    seen = Observations(episode.state, episode.environment_state)
    scenes = [
        Scene.read(environment.description, seen[row : row + 1])
        for row in range(len(episode.state))
    ]
    assert 0 < len(scenes) - 1 < 40 * 60  # some runs were undone
    assert all(milk.reach.can_start(scene) for scene in scenes[::60])


def test_goals_out_of_reach_are_refused(milk: World) -> None:
    milk.reset(0)
    scene = milk.environment.scene()
    corners = [[0.30, 0.42, 1.0, 0.0], [0.30, 0.42, 0.85, 0.0]]  # 0.95 m from the base
    assert not any(milk.reach.reachable(scene, np.array(corner)) for corner in corners)
    plain = ReachConfig(inverse_kinematics=False).build(scene.description)
    assert plain.reachable(scene, np.array([0.30, 0.1, 0.85, 0.0]))


def test_goals_inside_furniture_are_refused(milk: World) -> None:
    milk.reset(0)
    scene = milk.environment.scene()
    # A finger would stand in the wall between the two bins.
    assert not milk.reach.reachable(scene, np.array([0.1, 0.02, 0.83, 0.0]))


def test_goals_with_the_hand_in_a_thin_wall_are_refused() -> None:
    environment = TidyUpConfig(variant="A").build()
    environment.reset(seed=0)
    reach = ReachConfig().build(environment.description)
    scene = environment.scene()
    # Beside a bin whose wall is 1 cm thick: the palm reaches through it, or is along it.
    assert not reach.reachable(scene, np.array([-0.09, -0.05, 0.826, 1.56]))
    assert reach.reachable(scene, np.array([-0.09, -0.05, 0.826, 0.0]))


def test_grasps_from_the_prior_succeed(world: World) -> None:
    generator = np.random.default_rng(0)
    successes = []
    for seed in range(10):
        world.reset(seed)
        # One draw a reset; an object too far away for the arm counts as a failure.
        scene = world.environment.scene()
        drawn = world.grasp.propose(scene, generator)
        if not world.grasp.reachable(scene, drawn):
            successes.append(False)
            continue
        succeeded, execution = world.run(world.grasp, drawn)
        successes.append(succeeded)
        assert execution.finished
    assert np.mean(successes) >= 0.8


def test_places_from_the_prior_succeed(world: World) -> None:
    generator = np.random.default_rng(0)
    successes = []
    for seed in range(6):
        world.pick(seed)
        succeeded, execution = world.run(world.place, world.draw(world.place, generator))
        successes.append(succeeded)
        assert execution.finished
    assert np.mean(successes) >= 0.6


def test_a_nut_is_put_around_its_peg_by_a_grasp_and_a_place(nut: World) -> None:
    exact = PlaceConfig(position_std=(0.0, 0.0, 0.0), yaw_std=0.0)
    place = exact.build(nut.environment.description)
    generator = np.random.default_rng(0)
    solved, taken_off = [], []
    for seed in range(8):
        nut.pick(seed)
        nut.run(place, nut.draw(place, generator))
        settle(nut.environment)
        solved.append(nut.environment.is_success())
        nut.run(nut.grasp, nut.draw(nut.grasp, generator))
        nut.run(nut.reach, np.array([-0.1, -0.15, 0.95, 0.0]))
        taken_off.append(nut.environment.scene().held == "nut")
    assert np.mean(solved) >= 0.8
    assert np.mean(taken_off) >= 0.6


def test_held_stays_held_on_the_way(world: World) -> None:
    generator = np.random.default_rng(1)
    for seed in range(4):
        world.pick(seed)
        held = world.environment.scene().held
        _, execution = world.run(world.reach, world.draw(world.reach, generator))
        assert {scene.held for scene in execution.scenes} == {held}


def test_the_same_start_gives_the_same_motion_whatever_came_before(lift: World) -> None:
    lift.reset(5)
    state = lift.environment.get_state()
    goal = np.array([0.1, 0.2, 0.83, -1.0])
    first = lift.run(lift.reach, goal)[1]
    lift.run(lift.reach, np.array([-0.1, -0.2, 0.83, 1.0]))
    lift.environment.set_state(state)
    again = lift.run(lift.reach, goal)[1]
    assert np.array_equal(first.actions, again.actions)
    fresh = ReachConfig().build(lift.environment.description)
    lift.environment.set_state(state)
    assert np.array_equal(first.actions, lift.run(fresh, goal)[1].actions)


@pytest.mark.parametrize("config", [ReachConfig(), GraspConfig(), PlaceConfig()])
def test_primitives_keep_the_contract(
    config: ReachConfig | GraspConfig | PlaceConfig, lift: World
) -> None:
    def prepare(environment: Environment) -> None:
        scene = environment.scene()
        if isinstance(config, PlaceConfig):
            lift.run(lift.grasp, lift.grasp.propose(scene, np.random.default_rng(0)))

    check_primitive(config.build(lift.environment.description), lift.environment, prepare)

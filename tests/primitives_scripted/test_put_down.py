"""A place that counts put down what it held where its parameters say."""

from dataclasses import replace

import numpy as np

from prime_core.contracts.scene import Scene
from prime_core.execution.motions import MotionRun, run_actions, settle, step

from .conftest import World

HIGHER = np.array([0.0, 0.0, 0.12, 0.0])


def standing(world: World) -> np.ndarray:
    """Return where the gripper is that holds what it has just grasped, ``(4,)``."""
    scene = world.environment.scene()
    return np.append(scene.gripper_position, scene.gripper_yaw).clip(
        world.place.parameter_space.low, world.place.parameter_space.high
    )


def test_what_is_put_down_counts_and_stays_and_what_is_dropped_does_not(milk: World) -> None:
    milk.pick(1)
    here, state = standing(milk), milk.environment.get_state()
    succeeded, execution = milk.run(milk.place, here)
    assert succeeded
    lies = execution.scenes[-1].object_positions[0]
    run_actions(milk.environment, np.tile([0.0, 0.0, 0.04, 0.0, -1.0], (15, 1)))  # the hand goes
    assert np.linalg.norm(milk.environment.scene().object_positions[0] - lies) < 0.003
    milk.environment.set_state(state)
    dropped, execution = milk.run(milk.place, here + HIGHER)
    assert execution.scenes[-1].held is None
    assert not dropped


def test_a_place_that_stands_higher_than_it_was_called_to_does_not_count(milk: World) -> None:
    milk.pick(1)
    lower = standing(milk) - np.array([0.0, 0.0, 0.02, 0.0])
    # The hand has to rise first: where it is, it would not notice that the milk stands.
    assert milk.run(milk.reach, standing(milk) + HIGHER)[0]
    succeeded, execution = milk.run(milk.place, lower)
    after = execution.scenes[-1]
    assert after.held is None
    assert after.object_positions[0, 2] > 0.85  # upright
    assert not succeeded


def test_a_nut_that_slides_down_its_peg_counts(nut: World) -> None:
    generator = np.random.default_rng(0)
    counted = around = 0
    for seed in range(6):
        nut.pick(seed)
        succeeded, _ = nut.run(nut.place, nut.draw(nut.place, generator))
        settle(nut.environment)
        if nut.environment.is_success():
            around += 1
            counted += succeeded
    assert around >= 3
    assert counted >= around - 1


def test_motions_need_no_objects(lift: World) -> None:
    lift.reset(2)
    generator = np.random.default_rng(2)
    for primitive in (lift.grasp, lift.reach, lift.place):
        drawn = lift.draw(primitive, generator)
        command = -1.0 if primitive is lift.grasp else 1.0
        blind = _without_objects(lift.environment.scene(), command)
        assert primitive.can_start(blind)
        assert primitive.reachable(blind, drawn)
        run, scenes = MotionRun(primitive, blind, drawn), [lift.environment.scene()]
        while (action := run.next_action(_without_objects(scenes[-1], command))) is not None:
            step(lift.environment, action)
            command = float(action[4])
            scenes.append(lift.environment.scene())
        assert primitive.succeeded(scenes, drawn)


def _without_objects(scene: Scene, command: float) -> Scene:
    return replace(scene, objects=None, gripper_command=command)

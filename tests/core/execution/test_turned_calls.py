"""Calls with the gripper turned: to other good yaws of the object, or to any."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.checks.samples import DESCRIPTION, SPACE, sample_observations
from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall
from prime_core.contracts.description import Affordance
from prime_core.contracts.scene import Scene
from prime_core.execution.turned_calls import calls_at_any_yaw, calls_at_good_yaws
from prime_core.rotations import yaw_of

POSE = SPACE.parameter_spaces[0]
HERE = (0.0, 0.0, 0.0)


def scene_with(*affordances: Affordance) -> Scene:
    description = replace(DESCRIPTION, affordances=affordances)
    return Scene.read(description, sample_observations(np.random.default_rng(0), 1))


def grasp(scene: Scene, yaw: float, beside: float = 0.01) -> PrimitiveCall:
    """Return a grasp of the cube at a yaw relative to it."""
    x, y, _ = scene.object_positions[0]
    base = float(yaw_of(scene.object_quaternions[0]))
    turned = (base + yaw + np.pi / 2) % np.pi - np.pi / 2
    return PrimitiveCall("grasp", np.array([x + beside, y, 0.9, turned]))


def test_a_call_is_turned_to_the_other_good_yaws() -> None:
    scene = scene_with(Affordance("grasp", "cube", HERE, HERE, yaws=(0.0, np.pi / 2)))
    call = grasp(scene, 0.1)
    (turned,) = calls_at_good_yaws(call, POSE, scene)
    assert turned.primitive == "grasp"
    assert np.array_equal(turned.parameters[:3], call.parameters[:3])
    turn = POSE.difference(turned.parameters, call.parameters)[3]
    assert abs(turn) == pytest.approx(np.pi / 2)
    (back,) = calls_at_good_yaws(turned, POSE, scene)
    assert back.parameters[3] == pytest.approx(call.parameters[3])


@pytest.mark.parametrize(
    "affordances",
    [
        (),
        (Affordance("grasp", "cube", HERE, HERE, yaws=(0.0,)),),
        (Affordance("grasp", "cube", HERE, HERE),),
        (Affordance("place", "cube", HERE, HERE, yaws=(0.0, np.pi / 2)),),
        (Affordance("grasp", None, HERE, HERE, yaws=(0.0, np.pi / 2)),),
    ],
)
def test_without_another_good_yaw_there_is_no_other_call(
    affordances: tuple[Affordance, ...],
) -> None:
    scene = scene_with(*affordances)
    assert not list(calls_at_good_yaws(grasp(scene, 0.1), POSE, scene))


def test_a_call_far_from_all_objects_is_about_none() -> None:
    scene = scene_with(Affordance("grasp", "cube", HERE, HERE, yaws=(0.0, np.pi / 2)))
    assert not list(calls_at_good_yaws(grasp(scene, 0.1, beside=0.06), POSE, scene))


def test_without_known_objects_no_yaw_is_known_to_be_good() -> None:
    scene = scene_with(Affordance("grasp", "cube", HERE, HERE, yaws=(0.0, np.pi / 2)))
    call = grasp(scene, 0.1)
    assert list(calls_at_good_yaws(call, POSE, scene))
    assert not list(calls_at_good_yaws(call, POSE, replace(scene, objects=None)))


def test_a_call_without_a_yaw_is_not_turned() -> None:
    scene = scene_with(Affordance("grasp", "cube", HERE, HERE, yaws=(0.0, np.pi / 2)))
    space = ParameterSpace((Parameter("x", "m", -1.0, 1.0),))
    assert not list(calls_at_good_yaws(PrimitiveCall("grasp", np.zeros(1)), space, scene))


def test_a_call_is_turned_ever_farther_within_its_period() -> None:
    call = PrimitiveCall("grasp", np.array([0.1, 0.0, 0.9, 0.5]))
    turned = list(calls_at_any_yaw(call, POSE))
    assert all(np.array_equal(item.parameters[:3], call.parameters[:3]) for item in turned)
    turns = np.array(
        [float(POSE.difference(item.parameters, call.parameters)[3]) for item in turned]
    )
    assert len(turned) == 10
    assert np.abs(turns[:2]) == pytest.approx([np.pi / 12] * 2)
    assert np.all(np.diff(np.abs(turns)) > -1e-9)
    assert all(POSE.contains(item.parameters) for item in turned)


def test_without_a_yaw_there_is_no_other_one() -> None:
    space = ParameterSpace((Parameter("z", "m", 0.0, 1.0),))
    assert not list(calls_at_any_yaw(PrimitiveCall("rise", np.array([0.5])), space))

from dataclasses import replace

import numpy as np
import pytest

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall
from prime_core.contracts.description import Affordance
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.contracts.scene import Scene
from prime_policies.turned_calls import calls_at_any_yaw, turned_calls

from .toy_world import DESCRIPTION, SPACE, demonstrations

POSE = SPACE.parameter_spaces[1]
HERE = (0.0, 0.0, 0.0)


def scene_with(*affordances: Affordance) -> Scene:
    frames = demonstrations(seed=0, episodes=1).frames()
    observation = {
        STATE_KEY: frames.state[0],
        ENVIRONMENT_STATE_KEY: frames.environment_state[0],
    }
    return replace(DESCRIPTION, affordances=affordances).scene(observation)


def grasp(scene: Scene, yaw: float, beside: float = 0.01) -> PrimitiveCall:
    x, y, z = scene.object_positions[0]
    return PrimitiveCall("grasp", np.array([x + beside, y, z, yaw]))


def test_a_call_is_turned_to_the_other_good_yaws() -> None:
    scene = scene_with(Affordance("grasp", "carton", HERE, HERE, yaws=(0.0, np.pi / 2)))
    call = grasp(scene, 0.1)
    (turned,) = turned_calls(call, POSE, scene)
    assert turned.primitive == "grasp"
    assert np.array_equal(turned.parameters[:3], call.parameters[:3])
    assert abs(turned.parameters[3]) == pytest.approx(np.pi / 2 - 0.1)
    (back,) = turned_calls(turned, POSE, scene)
    assert back.parameters[3] == pytest.approx(0.1)


@pytest.mark.parametrize(
    "affordances",
    [
        (),
        (Affordance("grasp", "carton", HERE, HERE, yaws=(0.0,)),),
        (Affordance("grasp", "carton", HERE, HERE),),
        (Affordance("place", "carton", HERE, HERE, yaws=(0.0, np.pi / 2)),),
        (Affordance("grasp", None, HERE, HERE, yaws=(0.0, np.pi / 2)),),
    ],
)
def test_without_another_good_yaw_there_is_no_other_call(
    affordances: tuple[Affordance, ...],
) -> None:
    scene = scene_with(*affordances)
    assert not list(turned_calls(grasp(scene, 0.1), POSE, scene))


def test_a_call_far_from_all_objects_is_about_none() -> None:
    scene = scene_with(Affordance("grasp", "carton", HERE, HERE, yaws=(0.0, np.pi / 2)))
    assert not list(turned_calls(grasp(scene, 0.1, beside=0.06), POSE, scene))


def test_a_call_without_a_yaw_is_not_turned() -> None:
    scene = scene_with(Affordance("grasp", "carton", HERE, HERE, yaws=(0.0, np.pi / 2)))
    space = ParameterSpace((Parameter("x", "m", -1.0, 1.0),))
    assert not list(turned_calls(PrimitiveCall("grasp", np.zeros(1)), space, scene))


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

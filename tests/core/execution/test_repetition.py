"""What counts as the same call again."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall
from prime_core.contracts.scene import Scene
from prime_core.execution.repetition import CallHistory

from ..point_mass import PointMass
from .test_evaluation import Rise, Stay

CALL = PrimitiveCall("rise", np.array([0.5]))


@pytest.fixture
def scene() -> Scene:
    environment = PointMass()
    environment.reset(seed=0)
    return environment.scene()


def after(*scenes: Scene) -> CallHistory:
    history = CallHistory({"rise": Rise(), "stay": Stay()})
    for item in scenes:
        history.add(item, CALL)
    return history


def moved(scene: Scene, distance: float) -> Scene:
    return replace(scene, object_positions=scene.object_positions + np.array([distance, 0.0, 0.0]))


def test_a_call_may_be_made_once_more_and_no_more(scene: Scene) -> None:
    assert not after().is_worn_out(scene, CALL)
    assert not after(scene).is_worn_out(scene, CALL)
    assert after(scene, scene).is_worn_out(scene, CALL)


def test_calls_and_scenes_need_only_be_alike(scene: Scene) -> None:
    elsewhere = replace(scene, gripper_position=scene.gripper_position + 0.1)
    history = after(scene, elsewhere)
    assert history.is_worn_out(moved(scene, 0.008), CALL)
    assert history.is_worn_out(scene, PrimitiveCall("rise", np.array([0.515])))
    assert not history.is_worn_out(scene, PrimitiveCall("rise", np.array([0.525])))
    assert not history.is_worn_out(scene, PrimitiveCall("stay", np.array([0.5])))


def test_parameters_in_other_units_are_alike_within_a_share_of_their_range(scene: Scene) -> None:
    press = Rise()
    press.parameter_space = ParameterSpace((Parameter("force", "N", 0.0, 20.0),))
    history = CallHistory({"rise": press})
    for _ in range(2):
        history.add(scene, PrimitiveCall("rise", np.array([5.0])))
    assert history.is_worn_out(scene, PrimitiveCall("rise", np.array([5.9])))
    assert not history.is_worn_out(scene, PrimitiveCall("rise", np.array([6.1])))


def test_another_scene_makes_it_another_call(scene: Scene) -> None:
    history = after(scene, scene)
    assert not history.is_worn_out(moved(scene, 0.012), CALL)
    name = scene.description.objects[0].name
    assert not history.is_worn_out(replace(scene, held=name), CALL)

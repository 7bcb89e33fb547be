"""What counts as the same call again, and as a change."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall
from prime_core.contracts.scene import Scene
from prime_core.execution.repetition import CallHistory, has_changed
from prime_core.rotations import gripper_down

from ..point_mass import PointMass
from .toys import Rise, Stay

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
    positions = scene.object_positions + np.array([distance, 0.0, 0.0])
    return replace(scene, objects=replace(scene.known_objects, positions=positions))


def holding(scene: Scene, name: str | None) -> Scene:
    return replace(scene, objects=replace(scene.known_objects, held=name))


def blind(scene: Scene, opening: float, command: float | None) -> Scene:
    return replace(scene, objects=None, gripper_opening=opening, gripper_command=command)


def test_calls_are_counted(scene: Scene) -> None:
    assert after().count(scene, CALL) == 0
    assert after(scene).count(scene, CALL) == 1
    assert after(scene, scene).count(scene, CALL) == 2


def test_calls_and_scenes_need_only_be_alike(scene: Scene) -> None:
    elsewhere = replace(scene, gripper_position=scene.gripper_position + 0.1)
    history = after(scene, elsewhere)
    assert history.count(moved(scene, 0.008), CALL) == 2
    assert history.count(scene, PrimitiveCall("rise", np.array([0.515]))) == 2
    assert history.count(scene, PrimitiveCall("rise", np.array([0.525]))) == 0
    assert history.count(scene, PrimitiveCall("stay", np.array([0.5]))) == 0


def test_parameters_in_other_units_are_alike_within_a_share_of_their_range(scene: Scene) -> None:
    press = Rise()
    press.parameter_space = ParameterSpace((Parameter("force", "N", 0.0, 20.0),))
    history = CallHistory({"rise": press})
    for _ in range(2):
        history.add(scene, PrimitiveCall("rise", np.array([5.0])))
    assert history.count(scene, PrimitiveCall("rise", np.array([5.9]))) == 2
    assert history.count(scene, PrimitiveCall("rise", np.array([6.1]))) == 0


def test_another_scene_makes_it_another_call(scene: Scene) -> None:
    history = after(scene, scene)
    assert history.count(moved(scene, 0.012), CALL) == 0
    assert history.count(holding(scene, scene.description.objects[0].name), CALL) == 0


def test_without_objects_scenes_are_alike_where_as_much_is_held(scene: Scene) -> None:
    empty, full = blind(scene, 0.08, -1.0), blind(scene, 0.05, 1.0)
    history = after(empty, empty)
    assert history.count(blind(scene, 0.04, None), CALL) == 2
    assert history.count(full, CALL) == 0
    # Where one of the two tells no objects, where they are cannot be compared.
    assert history.count(moved(scene, 0.5), CALL) == 2


@pytest.mark.parametrize(("distance", "changed"), [(0.008, False), (0.012, True)])
def test_what_is_elsewhere_by_more_than_a_centimetre_has_changed(
    scene: Scene, distance: float, changed: bool
) -> None:
    shifted = replace(scene, gripper_position=scene.gripper_position + np.array([0, 0, distance]))
    assert has_changed(scene, shifted) is changed
    assert has_changed(scene, moved(scene, distance)) is changed
    assert has_changed(blind(scene, 0.08, -1.0), blind(shifted, 0.08, -1.0)) is changed


@pytest.mark.parametrize(("turn", "changed"), [(0.09, False), (-0.09, False), (0.11, True)])
def test_a_turn_of_the_gripper_is_a_change(scene: Scene, turn: float, changed: bool) -> None:
    start = replace(scene, gripper_quaternion=gripper_down(np.pi - 0.05))
    turned = replace(scene, gripper_quaternion=gripper_down(np.pi - 0.05 + turn))
    assert has_changed(start, turned) is changed


def test_what_is_taken_or_let_go_of_is_a_change(scene: Scene) -> None:
    first, second = (item.name for item in scene.description.objects)
    assert has_changed(scene, holding(scene, first))
    assert has_changed(holding(scene, first), holding(scene, second))
    assert has_changed(blind(scene, 0.05, 1.0), blind(scene, 0.05, -1.0))
    assert not has_changed(blind(scene, 0.05, 1.0), blind(scene, 0.04, 1.0))


def test_an_object_that_turns_in_place_does_not_count(scene: Scene) -> None:
    quaternions = np.tile([0.0, 0.0, 0.0, 1.0], (2, 1))
    turned = replace(scene, objects=replace(scene.known_objects, quaternions=quaternions))
    assert not has_changed(scene, turned)

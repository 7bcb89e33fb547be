"""Each criterion of success and of starting can fail, for each of its reasons."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.contracts.scene import Scene
from prime_primitives_scripted.grasp import GraspConfig
from prime_primitives_scripted.place import OPENING_STEPS, PlaceConfig
from prime_primitives_scripted.reach import ReachConfig

from .floating_gripper import DESCRIPTION, block_moved, held_now, scene_at

HERE = np.array([0.1, 0.0, 0.9, 0.3])
reach = ReachConfig().build(DESCRIPTION)
grasp = GraspConfig().build(DESCRIPTION)
place = PlaceConfig().build(DESCRIPTION)


def ended(held: str | None = None, by: float = 0.0, turned: float = 0.0) -> Scene:
    return scene_at(HERE[:3] + np.array([by, 0.0, 0.0]), HERE[3] + turned, held=held)


def test_what_may_start() -> None:
    empty, full = scene_at(), scene_at(held="block")
    assert reach.can_start(empty)
    assert reach.can_start(full)
    assert grasp.can_start(empty)
    assert not grasp.can_start(full)
    assert place.can_start(full)
    assert not place.can_start(empty)


@pytest.mark.parametrize("held", [None, "block"])
def test_reach_ends_within_tolerances(held: str | None) -> None:
    start = scene_at(held=held)
    assert reach.succeeded([start, ended(held, by=0.009, turned=0.19)], HERE)
    assert not reach.succeeded([start, ended(held, by=0.011)], HERE)
    assert not reach.succeeded([start, ended(held, turned=0.21)], HERE)


def test_a_half_turn_of_the_jaws_changes_nothing() -> None:
    assert reach.succeeded([scene_at(), ended(turned=np.pi)], HERE)
    assert not reach.succeeded([scene_at(), ended(turned=np.pi / 2)], HERE)


def test_reach_keeps_what_it_holds_and_takes_nothing_else() -> None:
    assert not reach.succeeded([scene_at(held="block"), ended()], HERE)
    assert not reach.succeeded([scene_at(), ended("block")], HERE)
    assert not reach.succeeded([scene_at(held="block"), ended("anvil")], HERE)


def test_grasp_holds_a_graspable_object_where_it_was_called_to() -> None:
    assert grasp.succeeded([scene_at(), ended("block")], HERE)
    assert not grasp.succeeded([scene_at(), ended()], HERE)
    assert not grasp.succeeded([scene_at(), ended("anvil")], HERE)
    assert not grasp.succeeded([scene_at(), ended("block", by=0.011)], HERE)
    assert not grasp.succeeded([scene_at(), ended("block", turned=0.21)], HERE)
    assert not grasp.succeeded([scene_at(held="block"), ended("block")], HERE)


def released(drop: float = -0.02, slide: float = 0.0) -> list[Scene]:
    """Scenes of a place: two on the way with the block held, then the gripper opens.

    The block moves by `slide` and `drop` [m] at once, and then lies where it is.
    """
    closed = replace(ended("block"), gripper_opening=0.03)
    widths = np.minimum(0.03 + 0.005 * np.arange(OPENING_STEPS), 0.08)
    opening = [
        block_moved(replace(ended(), gripper_opening=width), [slide, 0.0, drop]) for width in widths
    ]
    return [scene_at(held="block", opening=0.03), closed, *opening]


def test_place_lets_go_and_what_it_held_lies_there() -> None:
    assert place.succeeded(released(), HERE)


@pytest.mark.parametrize(
    ("drop", "slide", "fine"),
    [(-0.07, 0.0, True), (-0.09, 0.0, False), (-0.02, 0.02, True), (-0.02, 0.04, False)],
)
def test_place_puts_down_and_does_not_drop(drop: float, slide: float, fine: bool) -> None:
    assert place.succeeded(released(drop, slide), HERE) == fine


def test_how_far_things_may_fall_and_slide_are_settings() -> None:
    strict = PlaceConfig(greatest_fall=0.01, greatest_slide=0.005).build(DESCRIPTION)
    assert strict.succeeded(released(drop=-0.005), HERE)
    assert not strict.succeeded(released(drop=-0.02), HERE)
    assert not strict.succeeded(released(drop=-0.005, slide=0.01), HERE)


def test_place_fails_while_the_object_still_moves() -> None:
    scenes = released()
    scenes[-1] = block_moved(scenes[-1], [0.0, 0.0, -0.002])
    assert not place.succeeded(scenes, HERE)


def test_place_fails_where_it_let_go_higher_than_its_parameters_say() -> None:
    higher = HERE + np.array([0.0, 0.0, 0.011, 0.0])
    assert place.succeeded(released(), higher - [0.0, 0.0, 0.002, 0.0])
    assert not place.succeeded(released(), higher)


def test_where_the_hand_goes_after_the_release_does_not_matter() -> None:
    scenes = released()
    away = replace(scenes[-1], gripper_position=HERE[:3] + np.array([0.0, 0.0, 0.05]))
    assert place.succeeded([*scenes[:-1], away], HERE)


def test_place_fails_if_the_object_is_lost_on_the_way() -> None:
    scenes = released()
    scenes[1] = held_now(scenes[1], None)
    assert not place.succeeded(scenes, HERE)


def test_place_fails_if_it_lets_go_elsewhere() -> None:
    aside = np.array([0.011, 0.0, 0.0])
    scenes = [replace(item, gripper_position=HERE[:3] + aside) for item in released()]
    assert not place.succeeded(scenes, HERE)


def test_place_fails_if_the_fingers_are_only_forced_apart() -> None:
    scenes = [replace(item, gripper_opening=0.03 + 0.0001 * n) for n, item in enumerate(released())]
    assert not place.succeeded(scenes, HERE)


def test_place_fails_if_something_is_held_at_the_end() -> None:
    scenes = released()
    scenes[-1] = held_now(scenes[-1], "block")
    assert not place.succeeded(scenes, HERE)


def test_place_fails_if_it_held_nothing_or_ended_early_or_never_opened() -> None:
    scenes = released()
    assert not place.succeeded([scene_at(), *scenes[1:]], HERE)
    assert not place.succeeded(scenes[:5], HERE)
    shut = [replace(scene, gripper_opening=0.0) for scene in scenes[2:]]
    assert not place.succeeded([*scenes[:2], *shut], HERE)

"""How motions are made, in a world without an arm."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.scene import Scene
from prime_primitives_scripted.goal import equivalent_goals
from prime_primitives_scripted.grasp import GraspConfig
from prime_primitives_scripted.place import PlaceConfig
from prime_primitives_scripted.reach import ReachConfig

from .floating_gripper import DESCRIPTION, play, scene_at

FAR = np.array([0.25, -0.2, 0.85, 0.5])
reach = ReachConfig().build(DESCRIPTION)
grasp = GraspConfig().build(DESCRIPTION)
place = PlaceConfig().build(DESCRIPTION)


@pytest.mark.parametrize("start", [scene_at((-0.2, 0.2, 0.82)), scene_at((-0.2, 0.2, 1.2))])
def test_reach_lifts_travels_at_the_lift_height_and_descends(start: Scene) -> None:
    scenes, actions = play(start, reach.motion(start, FAR))
    places = np.array([scene.gripper_position for scene in scenes])
    across = np.linalg.norm(places[:, :2] - places[0, :2], axis=1)
    under_way = (across > 0.1) & (np.linalg.norm(places[:, :2] - FAR[:2], axis=1) > 0.05)
    assert np.all(places[under_way, 2] > 0.97)
    # The height does not depend on where the motion starts: nothing ratchets upward.
    assert np.all(places[1:, 2] <= max(places[0, 2], 1.0) + 1e-9)
    assert np.linalg.norm(places[-1] - FAR[:3]) < 0.0015
    assert reach.succeeded(scenes, FAR)
    assert np.all(np.abs(actions) <= ACTION_LIMIT)


def test_what_is_above_its_goal_goes_straight_down() -> None:
    start = scene_at((*FAR[:2], 0.9), FAR[3])
    scenes, _ = play(start, reach.motion(start, FAR))
    assert max(scene.gripper_position[2] for scene in scenes) <= 0.9


@pytest.mark.parametrize(
    ("held", "opening", "command"), [(None, 0.08, -1.0), (None, 0.0, 1.0), ("block", 0.06, 1.0)]
)
def test_reach_keeps_the_gripper_as_it_is(held: str | None, opening: float, command: float) -> None:
    start = scene_at(held=held, opening=opening)
    _, actions = play(start, reach.motion(start, FAR))
    assert {action[4] for action in actions} == {command}


def test_grasp_closes_at_its_end() -> None:
    _, actions = play(scene_at(), grasp.motion(scene_at(), FAR))
    gripper = np.array([action[4] for action in actions])
    assert np.all(gripper[:-10] == -1.0)
    assert np.all(gripper[-10:] == 1.0)


def test_place_opens_at_its_end() -> None:
    start = scene_at(held="block", opening=0.03)
    _, actions = play(start, place.motion(start, FAR))
    gripper = np.array([action[4] for action in actions])
    assert np.all(gripper[:-10] == 1.0)
    assert np.all(gripper[-10:] == -1.0)


def test_place_lets_go_where_the_way_down_is_blocked() -> None:
    def on_the_floor(scene: Scene) -> Scene:
        position = scene.gripper_position.copy()
        position[2] = max(position[2], 0.9)
        return replace(scene, gripper_position=position)

    start = scene_at(held="block", opening=0.03)
    _, actions = play(start, place.motion(start, FAR), on_the_floor)
    assert actions[-1][4] == -1.0


def test_a_gripper_that_cannot_move_is_given_up_and_does_nothing_at_the_end() -> None:
    for primitive, held in ((reach, None), (grasp, None), (place, "block")):
        start = scene_at(held=held)
        _, actions = play(start, primitive.motion(start, FAR), share=0.0)
        assert len(actions) == 70
        assert {action[4] for action in actions} == {1.0 if held else -1.0}


def test_step_limits() -> None:
    assert (reach.maximum_steps, grasp.maximum_steps, place.maximum_steps) == (70, 80, 80)
    slow = ReachConfig(approach_steps=7).build(DESCRIPTION)
    assert len(play(scene_at(), slow.motion(scene_at(), FAR))[1]) == 7


def test_a_motion_always_acts() -> None:
    start = scene_at(FAR[:3], FAR[3])
    assert len(play(start, reach.motion(start, FAR))[1]) >= 1


def test_the_jaws_take_the_shorter_of_two_turns() -> None:
    near, far = equivalent_goals(np.array([0.0, 0.0, 0.9, -1.5]), 1.4)
    assert near[3] == pytest.approx(np.pi - 1.5)
    assert abs(far[3] - near[3]) == pytest.approx(np.pi)
    assert abs(near[3] - 1.4) <= abs(far[3] - 1.4)


def test_a_call_beyond_the_workspace_is_refused() -> None:
    assert reach.reachable(scene_at(), FAR)
    assert not reach.reachable(scene_at(), FAR + np.array([0.1, 0.0, 0.0, 0.0]))

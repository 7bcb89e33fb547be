"""How motions are made, in a world without an arm."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.affordances.goals import equivalent_goals
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.scene import Scene
from prime_primitives_scripted.grasp import CLOSING_STEPS, GraspConfig
from prime_primitives_scripted.phases import SLOW_STEP, STALL_STEPS
from prime_primitives_scripted.place import OPENING_STEPS, PlaceConfig
from prime_primitives_scripted.reach import ReachConfig
from prime_primitives_scripted.step_limits import approach_limit

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


def test_grasp_closes_at_its_end_once_the_hand_is_still() -> None:
    scenes, actions = play(scene_at(), grasp.motion(scene_at(), FAR))
    gripper = np.array([action[4] for action in actions])
    assert np.all(gripper[:-CLOSING_STEPS] == -1.0)
    assert np.all(gripper[-CLOSING_STEPS:] == 1.0)
    before, closing = (item.gripper_position for item in scenes[-CLOSING_STEPS - 2 :][:2])
    assert np.linalg.norm(closing - before) < SLOW_STEP


def test_grasp_does_not_close_while_the_hand_is_shaken() -> None:
    tick = iter(range(1000))

    def shaken(scene: Scene) -> Scene:
        by = np.array([0.004 if next(tick) % 2 else -0.004, 0.0, 0.0])
        return replace(scene, gripper_position=scene.gripper_position + by)

    _, actions = play(scene_at(), grasp.motion(scene_at(), FAR), shaken)
    assert {action[4] for action in actions} == {-1.0}


def test_place_opens_at_its_end() -> None:
    start = scene_at(held="block", opening=0.03)
    _, actions = play(start, place.motion(start, FAR))
    gripper = np.array([action[4] for action in actions])
    assert np.all(gripper[:-OPENING_STEPS] == 1.0)
    assert np.all(gripper[-OPENING_STEPS:] == -1.0)


def test_a_hand_that_is_aside_of_its_goal_waits_above_it() -> None:
    aside = np.array([0.008, 0.0, 0.0])

    def pulled_aside(scene: Scene) -> Scene:
        near = scene.gripper_position[2] < FAR[2] + 0.02
        held_off = FAR[:3] + aside
        held_off[2] = scene.gripper_position[2]
        return replace(scene, gripper_position=held_off) if near else scene

    scenes, _ = play(scene_at(), reach.motion(scene_at(), FAR), pulled_aside)
    lowest = min(scene.gripper_position[2] for scene in scenes)
    assert FAR[2] + 0.003 < lowest < FAR[2] + 0.006
    straight, _ = play(scene_at(), reach.motion(scene_at(), FAR))
    assert straight[-1].gripper_position[2] == pytest.approx(FAR[2], abs=0.0015)


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
        _, actions = play(start, primitive.motion(start, FAR), strength=0.0)
        assert len(actions) <= 3 * STALL_STEPS  # lifting, travelling and descending
        assert {action[4] for action in actions} == {1.0 if held else -1.0}


def test_a_far_goal_may_take_longer_than_a_near_one() -> None:
    near = np.array([0.05, 0.0, 0.9, 0.0])
    turned = near + np.array([0.0, 0.0, 0.0, 1.5])
    limits = [approach_limit(scene_at(), goal) for goal in (near, turned, FAR)]
    assert limits == sorted(limits)
    assert limits[0] < limits[1] < limits[2] <= reach.maximum_steps
    assert reach.maximum_steps < grasp.maximum_steps < place.maximum_steps


def test_a_slow_arm_arrives_and_one_that_never_settles_is_stopped_by_its_limit() -> None:
    slow = 0.5  # of its speed: 6 mm a step
    start = scene_at((-0.3, 0.3, 0.82), yaw=-1.5)
    far = np.array([0.3, -0.3, 0.82, 1.2])
    scenes, _ = play(start, reach.motion(start, far), strength=slow)
    assert reach.succeeded(scenes, far)

    tick = iter(range(1000))

    def shaken(scene: Scene) -> Scene:
        by = np.array([0.01 if next(tick) % 2 else -0.01, 0.0, 0.0])
        return replace(scene, gripper_position=scene.gripper_position + by)

    _, actions = play(start, reach.motion(start, far), shaken)
    assert len(actions) == approach_limit(start, reach._goal(start, far))


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

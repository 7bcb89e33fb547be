"""Far goals: no limit of steps cuts a motion off that is on its way."""

import numpy as np

from prime_primitives_scripted.step_limits import approach_limit

from .conftest import World

BEFORE = 70  # steps, the limit of the paper


def test_reaches_across_the_workspace_arrive(milk: World) -> None:
    low, high = milk.reach.parameter_space.low, milk.reach.parameter_space.high
    corners = [
        np.array([0.05, y, low[2] + 0.06, yaw]) for y, yaw in ((high[1], -1.5), (low[1], 1.5))
    ]
    milk.reset(0)
    steps = []
    for number in range(3):
        scene = milk.environment.scene()
        ways = np.linspace(corners[number % 2], corners[1 - number % 2], 20)
        goal = next(point for point in ways if milk.reach.reachable(scene, point))
        succeeded, execution = milk.run(milk.reach, goal)
        assert succeeded
        assert execution.steps < approach_limit(scene, milk.reach._goal(scene, goal))
        steps.append(execution.steps)
    assert max(steps) > BEFORE


def test_a_motion_from_outside_of_the_workspace_has_the_time_for_it(milk: World) -> None:
    milk.reset(0)
    description = milk.environment.description
    longest = np.linalg.norm(np.subtract(description.workspace_high, description.workspace_low)[:2])
    assert milk.reach.maximum_steps > 2 * longest / 0.0128  # [m] a step of robosuite's controller

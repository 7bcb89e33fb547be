"""How a grasp comes down: not below its goal, and at rest before the fingers close."""

import numpy as np
import pytest

from prime_primitives_scripted.grasp import CLOSING_STEPS

from .conftest import World

DEEPEST = 0.003  # [m] below the goal
FASTEST = 0.001  # [m] a step, 20 mm/s, when the fingers begin to close


@pytest.mark.parametrize("name", ["lift", "milk", "nut"])
def test_descents_stop_at_their_goal_and_fingers_close_at_rest(
    name: str, request: pytest.FixtureRequest
) -> None:
    world: World = request.getfixturevalue(name)
    generator = np.random.default_rng(0)
    closed = 0
    for seed in range(4):
        world.reset(seed)
        if seed % 2:  # from afar, so that the arm still swings when it comes down
            away = world.draw(world.reach, generator, uniform=True)
            world.run(world.reach, away)
        drawn = world.draw(world.grasp, generator)
        succeeded, execution = world.run(world.grasp, drawn)
        first = execution.steps - CLOSING_STEPS
        if not succeeded:
            continue
        closed += 1
        heights = [scene.gripper_position[2] for scene in execution.scenes[: first + 1]]
        assert min(heights[int(np.argmax(heights)) :]) > drawn[2] - DEEPEST
        here, before = (execution.scenes[at].gripper_position for at in (first, first - 1))
        assert np.linalg.norm(here - before) < FASTEST
    assert closed >= 3

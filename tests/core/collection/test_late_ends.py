"""Later frames that tell the parameters of a rollout as well as its own end."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.collection.late_ends import LATEST, draw_late_ends
from prime_core.contracts.scene import Scene

from ..point_mass import PointMass

ROLLOUT = (0, 10, 0)
"""Moves an object within its ten steps."""


def scenes(count: int = 100) -> list[Scene]:
    """Return an object that is moved by 10 cm until frame 10, and then lies."""
    environment = PointMass()
    environment.reset(seed=0)
    found = []
    for frame in range(count):
        scene = environment.scene()
        scene.object_positions[0] = [0.01 * min(frame, 10), 0.0, 0.8]
        found.append(scene)
    return found


def late_ends(given: list[Scene], draws: int = 400) -> set[int]:
    generator = np.random.default_rng(0)
    found = [draw_late_ends(given, [ROLLOUT], generator) for _ in range(draws)]
    return {int(item[0]) for item in found}


def test_any_frame_up_to_the_latest_may_be_the_late_end() -> None:
    assert late_ends(scenes()) == set(range(10, 10 + LATEST + 1))
    assert late_ends(scenes(31)) == set(range(10, 31))


def test_a_late_end_comes_before_an_object_moves_again() -> None:
    given = scenes()
    given[25].object_positions[1, 1] += 0.01
    assert late_ends(given) == set(range(10, 25))


def test_a_late_end_comes_before_something_is_held() -> None:
    given = scenes()
    given[25] = replace(given[25], objects=replace(given[25].known_objects, held="cube"))
    assert late_ends(given) == set(range(10, 25))


@pytest.mark.parametrize("reason", ["nothing moved", "held at the end"])
def test_other_rollouts_end_where_they_end(reason: str) -> None:
    given = scenes()
    if reason == "nothing moved":
        for scene in given[:11]:
            scene.object_positions[0, 0] = 0.1 - 0.015 * (scene is given[0])
    else:
        given[10] = replace(given[10], objects=replace(given[10].known_objects, held="cube"))
    assert late_ends(given) == {10}


def test_each_rollout_has_its_own() -> None:
    found = draw_late_ends(scenes(), [ROLLOUT, (20, 30, 1)], np.random.default_rng(0))
    assert found.dtype == np.int64
    assert 10 <= found[0] <= 10 + LATEST
    assert found[1] == 30
    assert draw_late_ends(scenes(), [], np.random.default_rng(0)).shape == (0,)

"""Object poses at random: fallen ones among them, held ones left alone."""

import numpy as np

from prime_core.checks.samples import sample_observations
from prime_core.collection.random_poses import with_random_poses
from prime_core.rotations import rotation_matrix


def test_objects_lie_elsewhere_and_in_any_way_but_held_ones_stay() -> None:
    seen = sample_observations(np.random.default_rng(0), 600)
    moved = with_random_poses(seen, np.random.default_rng(1))
    assert not moved.images
    np.testing.assert_array_equal(moved.state, seen.state)
    np.testing.assert_array_equal(moved.held, seen.held)
    held, free = seen.held, ~seen.held
    assert held.any()
    np.testing.assert_array_equal(moved.object_positions[held], seen.object_positions[held])
    np.testing.assert_array_equal(moved.object_quaternions[held], seen.object_quaternions[held])
    quaternions = moved.object_quaternions[free]
    np.testing.assert_allclose(np.linalg.norm(quaternions, axis=-1), 1, atol=1e-6)
    up = rotation_matrix(quaternions)[:, 2, 2]
    assert 0.2 < np.mean(up > 0.999) < 0.4  # upright
    assert 0.3 < np.mean(np.abs(up) < 0.3) < 0.6  # on its side
    way = np.linalg.norm((moved.object_positions - seen.object_positions)[free][:, :2], axis=-1)
    assert np.mean(way > 0.01) > 0.9


def test_they_follow_from_the_generator() -> None:
    seen = sample_observations(np.random.default_rng(0), 50)
    first, same, other = (
        with_random_poses(seen, np.random.default_rng(seed)).environment_state for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first, same)
    assert not np.array_equal(first, other)

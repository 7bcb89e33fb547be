"""Where an arm is kept from stretching."""

import numpy as np
import pytest

from prime_primitives_scripted.elbow import RESERVE, Elbow

RANGES = np.array([[-3.0, 3.0], [-3.0, 0.5], [-3.0, 3.0]])
CENTRE = -0.2  # where the two links below are in line


def length(joints: np.ndarray) -> float:
    """Two links of 0.3 m and 0.4 m that the second joint folds."""
    return float(np.hypot(0.3 + 0.4 * np.cos(joints[1] - CENTRE), 0.4 * np.sin(joints[1] - CENTRE)))


def test_the_elbow_is_kept_where_it_folds() -> None:
    elbow = Elbow.find(RANGES, length)
    assert elbow is not None
    assert elbow.joint == 1
    assert elbow.longest == pytest.approx(0.7, abs=1e-3)
    narrowed = elbow.narrow(RANGES)
    assert narrowed[1] == pytest.approx([-3.0, CENTRE - RESERVE], abs=0.02)
    assert np.array_equal(narrowed[[0, 2]], RANGES[[0, 2]])
    # An arm built the other way round folds above the centre.
    mirrored = Elbow.find(-RANGES[:, ::-1], lambda joints: length(-joints))
    assert mirrored is not None
    assert mirrored.narrow(-RANGES[:, ::-1])[1] == pytest.approx(-narrowed[1, ::-1])


def test_an_arm_without_an_elbow_is_left_alone() -> None:
    assert Elbow.find(RANGES, lambda joints: 0.5) is None


def test_stretching_is_braked_and_nothing_else() -> None:
    elbow = Elbow(1, CENTRE, 1.0, 0.7)
    arm = np.array([0.69, 0.0, 0.0])
    outward, inward = np.array([0.05, 0.0, 0.0, 0.2]), np.array([-0.05, 0.0, 0.0, 0.2])
    slowed = elbow.braked(outward, arm)
    assert 0.0 < slowed[0] < 0.01
    assert slowed[3] / slowed[0] == pytest.approx(outward[3] / outward[0])
    assert np.array_equal(elbow.braked(inward, arm), inward)
    assert np.array_equal(elbow.braked(outward, 0.5 * arm), outward)


def test_an_elbow_beyond_its_dead_centre_is_locked() -> None:
    elbow = Elbow(1, CENTRE, 1.0, 0.7)
    assert elbow.is_locked(np.array([0.0, CENTRE + 0.05, 0.0]))
    assert not elbow.is_locked(np.array([0.0, CENTRE - 0.05, 0.0]))

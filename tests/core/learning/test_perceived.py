"""What models see through a perception, and how good it is."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.checks.samples import CAMERAS, DESCRIPTION, sample_observations, sample_pairs
from prime_core.contracts.observations import Observations
from prime_core.contracts.perception import Perception
from prime_core.learning.perceived import perceived_calls
from prime_core.learning.perception_report import report_on_perception


class Off(Perception):
    """Tells the second object 3 mm aside, the first turned by 10 degrees; counts what it sees."""

    cameras = CAMERAS

    def __init__(self, truth: Observations) -> None:
        self.truth, self.looked_at = truth, 0

    def see(self, seen: Observations) -> Observations:
        self.looked_at += len(seen)
        rows = [int(np.flatnonzero((self.truth.state == row).all(axis=1))[0]) for row in seen.state]
        told = self.truth.environment_state
        assert told is not None
        told = told[rows].reshape(len(rows), -1, 8).copy()
        told[:, 1, 0] += 0.003
        half = np.radians(10) / 2
        w, z = told[:, 0, 3].copy(), told[:, 0, 6].copy()
        told[:, 0, 3] = np.cos(half) * w - np.sin(half) * z
        told[:, 0, 6] = np.sin(half) * w + np.cos(half) * z
        return Observations(seen.state, told.reshape(len(rows), -1))


def test_labels_mean_the_same_instants_and_no_others_are_looked_at() -> None:
    data = sample_pairs(0)
    few = replace(data, types=replace(data.types, rows=data.types.rows % 7))
    few = replace(few, parameters=replace(data.parameters, rows=data.parameters.rows % 5))
    perception = Off(data.observations)
    seen = perceived_calls(perception, few)
    assert perception.looked_at == len(seen.observations) == 7
    for before, after in ((few.types, seen.types), (few.parameters, seen.parameters)):
        expected = few.observations.state[before.rows]
        np.testing.assert_array_equal(seen.observations.state[after.rows], expected)
        np.testing.assert_array_equal(after.classes, before.classes)


def test_the_report_tells_errors_of_each_object() -> None:
    truth = sample_observations(np.random.default_rng(0), 400)
    report = report_on_perception(Off(truth), truth, DESCRIPTION)
    cube, plate = report["cube"], report["plate"]
    assert cube["position_mm"]["median"] == pytest.approx(0, abs=1e-3)
    assert cube["yaw_degrees"] == pytest.approx(10, abs=0.1)
    assert plate["position_mm"]["median"] == pytest.approx(3, abs=0.01)
    assert plate["near_gripper_mm"]["p90"] == pytest.approx(3, abs=0.01)
    assert "yaw_degrees" not in plate  # it has none: any turn of it looks the same
    assert cube["held_accuracy"] == 1.0 and cube["frames"] == 400


def test_where_nothing_is_near_there_is_no_figure() -> None:
    truth = sample_observations(np.random.default_rng(0), 5)
    far = replace(truth, state=truth.state + 5)
    near = report_on_perception(Off(far), far, DESCRIPTION)["cube"]["near_gripper_mm"]
    assert near == {"median": None, "p90": None}

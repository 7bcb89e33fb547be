import numpy as np
import pytest

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveSpace
from prime_policies.parameter_codec import ParameterCodec

SPACE = PrimitiveSpace(
    ("reach", "spin"),
    (
        ParameterSpace(
            (
                Parameter("x", "m", 0.2, 0.6),
                Parameter("yaw", "rad", -np.pi / 2, np.pi / 2, period=np.pi),
            )
        ),
        ParameterSpace((Parameter("yaw", "rad", -1.0, 2.0, period=2 * np.pi),)),
    ),
)
CODEC = ParameterCodec(SPACE)
REACH, SPIN = np.array([0]), np.array([1])


def test_bounds_become_minus_one_and_one() -> None:
    parameters = np.array([[0.2, 0.0], [0.6, 0.0]])
    targets = CODEC.targets(parameters, np.zeros(2, dtype=np.int64), np.zeros(2))
    assert targets[:, 0] == pytest.approx([-1, 1])


def test_angles_are_taken_the_short_way_from_the_gripper() -> None:
    targets = CODEC.targets(np.array([[0.4, 1.5]]), REACH, np.array([-1.5]))
    assert targets[0, 1] * np.pi / 2 == pytest.approx(3.0 - np.pi)


def test_what_is_coded_is_decoded() -> None:
    generator = np.random.default_rng(0)
    labels = generator.integers(2, size=50)
    parameters = np.zeros((50, 2))
    for row, label in zip(parameters, labels, strict=True):
        own = SPACE.parameter_spaces[label]
        row[: len(own)] = own.sample(generator)
    yaws = generator.uniform(-np.pi, np.pi, 50)
    decoded = CODEC.parameters(CODEC.targets(parameters, labels, yaws), labels, yaws)
    np.testing.assert_allclose(decoded, parameters, atol=1e-9)


def test_parameters_are_brought_within_their_bounds() -> None:
    decoded = CODEC.parameters(np.array([[5.0, 0.6]]), REACH, np.array([1.0]))
    assert decoded[0, 0] == 0.6
    assert decoded[0, 1] == pytest.approx(1.0 + 0.3 * np.pi - np.pi)


def test_an_angle_out_of_bounds_goes_to_the_bound_that_is_nearest_on_the_circle() -> None:
    # The bounds are -1 and 2: -1.5 is nearer to -1, and 3 (the same as -3.28) to 2.
    for angle, bound in ((-1.5, -1.0), (3.0, 2.0), (3.0 - 2 * np.pi, 2.0)):
        assert CODEC.parameters(np.zeros((1, 2)), SPIN, np.array([angle]))[0, 0] == bound


def test_padding_stays_zero() -> None:
    assert CODEC.targets(np.array([[0.5, 0.0]]), SPIN, np.array([1.0]))[0, 1] == 0
    assert CODEC.parameters(np.array([[0.5, 7.0]]), SPIN, np.array([1.0]))[0, 1] == 0

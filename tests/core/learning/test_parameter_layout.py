"""What the numbers of a primitive's parameters are, and what networks learn of them."""

import numpy as np

from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.learning.parameter_layout import ParameterLayout

POSE = ParameterSpace(
    (
        Parameter("x", "m", -0.5, 0.5),
        Parameter("y", "m", -0.5, 0.5),
        Parameter("z", "m", 0.8, 1.1),
        Parameter("yaw", "rad", -np.pi / 2, np.pi / 2, period=np.pi),
    )
)
PUSH = ParameterSpace(
    (*POSE.parameters, Parameter("dx", "m", -0.4, 0.4), Parameter("dy", "m", -0.4, 0.4),
     Parameter("dz", "m", -0.01, 0.01))
)  # fmt: skip


def test_a_displacement_is_learnt_as_where_it_ends() -> None:
    layout = ParameterLayout(PUSH)
    values = np.array([[0.1, 0.2, 0.9, 0.3, 0.05, -0.1, 0.005]])
    np.testing.assert_allclose(layout.targets(values)[0, 4:], [0.15, 0.1, 0.905])
    np.testing.assert_allclose(layout.parameters(layout.targets(values)), values)
    assert [group.kind for group in layout.groups] == [
        "plane",
        "height",
        "plane",
        "height",
        "angle",
    ]


def test_what_is_learnt_of_a_displacement_may_lie_ahead_of_its_end() -> None:
    layout = ParameterLayout(PUSH, ahead=0.1)
    values = np.array([[0.1, 0.2, 0.9, 0.3, 0.06, -0.08, 0.0], [0.1, 0.2, 0.9, 0.3, 0.0, 0.0, 0.0]])
    targets = layout.targets(values)
    np.testing.assert_allclose(targets[:, 4:], [[0.22, 0.04, 0.9], [0.1, 0.2, 0.9]])
    np.testing.assert_allclose(layout.parameters(targets), values, atol=1e-12)
    targets[0, 4:] = [0.13, 0.16, 0.9]  # nearer than that: there is nothing to move
    np.testing.assert_allclose(layout.parameters(targets)[0, 4:], 0.0)


def test_parameters_come_back_within_their_bounds() -> None:
    layout = ParameterLayout(POSE)
    found = layout.parameters(np.array([[0.9, 0.0, 0.7, np.pi / 2 + 0.2]]))[0]
    np.testing.assert_allclose(found, [0.5, 0.0, 0.8, -np.pi / 2 + 0.2])


def test_numbers_of_other_names_are_plain() -> None:
    layout = ParameterLayout(ParameterSpace((Parameter("height", "m", 0.0, 0.2),)))
    assert [group.kind for group in layout.groups] == ["number"]
    np.testing.assert_allclose(layout.parameters(layout.targets(np.array([[0.1]]))), [[0.1]])

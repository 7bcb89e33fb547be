"""The gate of mixtures: a component's weight follows from where its mean is."""

import numpy as np
import torch

from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.learning.parameter_layout import ParameterLayout
from prime_policies.networks.gate import Gate

LAYOUT = ParameterLayout(
    ParameterSpace(
        (
            Parameter("x", "m", -0.5, 0.5),
            Parameter("y", "m", -0.5, 0.5),
            Parameter("yaw", "rad", -np.pi / 2, np.pi / 2, period=np.pi),
        )
    )
)


def test_it_learns_which_of_two_places_is_chosen_and_for_any_component() -> None:
    torch.manual_seed(0)
    gate = Gate(LAYOUT)
    optimiser = torch.optim.Adam(gate.parameters(), 1e-2)
    generator = torch.Generator().manual_seed(0)
    for _ in range(200):  # what is chosen has y below 0, as if a wall were in the way elsewhere
        means = torch.rand(64, 2, 3, generator=generator) * 2 - 1
        means[:, 0, 1] = -means[:, 0, 1].abs()
        means[:, 1, 1] = means[:, 1, 1].abs()
        loss = -gate(means).log_softmax(dim=1)[:, 0].mean()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
    others = torch.tensor([[[0.3, 0.6, 0.1], [0.3, -0.6, 0.1], [-0.2, 0.4, 1.0]]])
    assert gate(others).argmax() == 1


def test_yaws_a_period_apart_are_the_same() -> None:
    gate = Gate(LAYOUT)
    means = torch.rand(4, 3, 3)
    later = means + torch.tensor([0.0, 0.0, float(np.pi / LAYOUT.scales[2])])
    torch.testing.assert_close(gate(means), gate(later), atol=1e-5, rtol=1e-4)


def test_no_gradient_reaches_the_means() -> None:
    means = torch.rand(4, 3, 3, requires_grad=True)
    gate = Gate(LAYOUT)
    gate(means * 1.0).sum().backward()
    assert means.grad is None or not means.grad.any()
    assert any(value.grad.abs().sum() > 0 for value in gate.parameters())

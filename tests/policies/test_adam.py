import torch
from torch import Tensor, nn

from prime_policies.adam import Adam


def gradients(step: int) -> list[Tensor]:
    generator = torch.Generator().manual_seed(step)
    return [torch.randn(4, 3, generator=generator), torch.randn(3, generator=generator)]


def start() -> list[nn.Parameter]:
    return [nn.Parameter(item.clone()) for item in gradients(99)]


def test_steps_are_those_of_torch() -> None:
    ours, theirs = start(), start()
    adam = Adam(ours, weight_decay=0.1)
    reference = torch.optim.AdamW(theirs, weight_decay=0.1)
    for step in range(20):
        adam.step(gradients(step), 0.01)
        reference.param_groups[0]["lr"] = 0.01
        for parameter, gradient in zip(theirs, gradients(step), strict=True):
            parameter.grad = gradient
        reference.step()
    for one, other in zip(ours, theirs, strict=True):
        torch.testing.assert_close(one, other, rtol=1e-5, atol=1e-6)


def test_a_restored_state_steps_to_the_same_bits() -> None:
    ours, copies = start(), start()
    first, second = Adam(ours, 0.1), Adam(copies, 0.1)
    for step in range(3):
        first.step(gradients(step), 0.01)
    second.restore(first.state())
    for one, other in zip(ours, copies, strict=True):
        other.data.copy_(one)
    first.step(gradients(3), 0.01)
    second.step(gradients(3), 0.01)
    assert all(torch.equal(one, other) for one, other in zip(ours, copies, strict=True))

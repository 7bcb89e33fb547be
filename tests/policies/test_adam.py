import torch
from torch import Tensor, nn

from prime_policies.adam import Adam


def gradients(step: int) -> list[Tensor]:
    generator = torch.Generator().manual_seed(step)
    return [torch.randn(4, 3, generator=generator), torch.randn(3, generator=generator)]


def start() -> list[nn.Parameter]:
    return [nn.Parameter(item.clone()) for item in gradients(99)]


def test_steps_are_those_of_the_paper() -> None:
    # Not torch's own optimiser: its first use imports torch's compiler for many seconds.
    ours, expected = start(), [item.detach().double() for item in start()]
    adam = Adam(ours, weight_decay=0.1)
    first, second = ([torch.zeros_like(item) for item in expected] for _ in range(2))
    for step in range(1, 21):
        adam.step(gradients(step), 0.01)
        for place, gradient in enumerate(gradients(step)):
            first[place] = 0.9 * first[place] + 0.1 * gradient
            second[place] = 0.999 * second[place] + 0.001 * gradient**2
            mean, square = first[place] / (1 - 0.9**step), second[place] / (1 - 0.999**step)
            direction = mean / (square.sqrt() + 1e-8) + 0.1 * expected[place]
            expected[place] = expected[place] - 0.01 * direction
    for one, other in zip(ours, expected, strict=True):
        torch.testing.assert_close(one.double(), other, rtol=1e-4, atol=1e-5)


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

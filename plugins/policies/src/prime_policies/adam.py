"""Adam with decoupled weight decay, whose state is a few plain tensors.

The optimiser of torch does the same, but its first use imports torch's compiler: seconds of every
process that trains for a minute. Reference: Loshchilov and Hutter, "Decoupled weight decay
regularization", 2019.
"""

from collections.abc import Iterable, Mapping

import torch
from torch import Tensor, nn

FIRST_DECAY, SECOND_DECAY = 0.9, 0.999
EPSILON = 1e-8


class Adam:
    """Steps parameters down their gradients.

    Args:
        parameters: What is trained.
        weight_decay: Share of a weight that is lost at each step, times the learning rate.
    """

    def __init__(self, parameters: Iterable[nn.Parameter], weight_decay: float) -> None:
        self._parameters = list(parameters)
        self._weight_decay = weight_decay
        self._first = [torch.zeros_like(item) for item in self._parameters]
        self._second = [torch.zeros_like(item) for item in self._parameters]
        self._steps = 0

    @torch.no_grad()
    def step(self, gradients: Iterable[Tensor], learning_rate: float) -> None:
        """Make a step.

        Args:
            gradients: One for each parameter.
            learning_rate: Of this step.
        """
        self._steps += 1
        rate = learning_rate / (1 - FIRST_DECAY**self._steps)
        correction = (1 - SECOND_DECAY**self._steps) ** 0.5
        for parameter, gradient, first, second in zip(
            self._parameters, gradients, self._first, self._second, strict=True
        ):
            first.lerp_(gradient, 1 - FIRST_DECAY)
            second.mul_(SECOND_DECAY).addcmul_(gradient, gradient, value=1 - SECOND_DECAY)
            parameter.mul_(1 - learning_rate * self._weight_decay)
            parameter.addcdiv_(first, (second.sqrt() / correction).add_(EPSILON), value=-rate)

    def state(self) -> dict[str, Tensor]:
        """Return the state as named tensors."""
        state = {"steps": torch.tensor(self._steps)}
        for place, (first, second) in enumerate(zip(self._first, self._second, strict=True)):
            state |= {f"first.{place}": first, f"second.{place}": second}
        return state

    def restore(self, state: Mapping[str, Tensor]) -> None:
        """Go back to a state."""
        self._steps = int(state["steps"])
        for place, (first, second) in enumerate(zip(self._first, self._second, strict=True)):
            first.copy_(state[f"first.{place}"])
            second.copy_(state[f"second.{place}"])

"""The networks: a classifier of primitives and a mixture of their parameters.

Both see one frame (a policy) or a pair of frames (an inverse dynamics model).
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional

from prime_policies.line_inputs import LineInputs
from prime_policies.linear import LinearFit
from prime_policies.mixture import Mixture, log_density

WIDENING = 1.5  # of a component against one with the same line, before the softplus
CLIP = 5.0  # normalised features beyond it are outside everything seen in training


class Examples(NamedTuple):
    """A batch to learn from.

    Attributes:
        frames: Features of the frames that a network sees at once, ``(n, frames, features)``.
        labels: Class or primitive, ``(n,)`` int64.
        targets: Of the parameters, ``(n, D)``; empty where classes are learnt.
    """

    frames: Tensor
    labels: Tensor
    targets: Tensor


class Trunk(nn.Module):
    """Normalises frames, joins those of a pair, and passes them through a perceptron.

    A pair enters as [f, f', f' - f]. The first layer is linear in it, so its value is a sum of
    a part of either frame: `halves` gives the parts, and `finish` does the rest.

    Args:
        features: Number of features of a frame.
        pair: Whether it sees pairs of frames.
        hidden: Widths of the hidden layers.
        noise: Standard deviation of the noise on normalised inputs while training.
    """

    mean: Tensor
    scale: Tensor
    difference_scale: Tensor

    def __init__(self, features: int, pair: bool, hidden: tuple[int, ...], noise: float) -> None:
        super().__init__()
        self._pair, self._noise = pair, noise
        self.register_buffer("mean", torch.zeros(features))
        self.register_buffer("scale", torch.ones(features))
        self.register_buffer("difference_scale", torch.ones(features))
        self.first = nn.Linear(3 * features if pair else features, hidden[0])
        layers: list[nn.Module] = []
        for before, after in pairwise(hidden):
            layers += [nn.Linear(before, after), nn.ReLU()]
        self.rest = nn.Sequential(*layers)

    def forward(self, frames: Tensor, generator: torch.Generator | None = None) -> Tensor:
        """Return the last hidden layer.

        Args:
            frames: ``(n, 1 or 2, features)``.
            generator: Of the input noise; None for no noise.
        """
        inputs = self._join(self._normalise(frames))
        if generator is not None and self._noise:
            inputs = inputs + self._noise * torch.randn(inputs.shape, generator=generator)
        return self.finish(self.first(inputs))

    def halves(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Return what each frame adds to the first layer as the start and as the end of a pair.

        Args:
            features: ``(frames, features)``.
        """
        normal = self._normalise(features)
        start, end, difference = self.first.weight.chunk(3, dim=1)
        difference = difference * (self.scale / self.difference_scale)
        return normal @ (start - difference).T + self.first.bias, normal @ (end + difference).T

    def finish(self, first: Tensor) -> Tensor:
        """Return the last hidden layer from the first one's value before its rectifier."""
        result: Tensor = self.rest(functional.relu(first))
        return result

    def _normalise(self, features: Tensor) -> Tensor:
        return ((features - self.mean) / self.scale).clamp(-CLIP, CLIP)

    def _join(self, normal: Tensor) -> Tensor:
        if not self._pair:
            return normal[:, 0]
        start, end = normal[:, 0], normal[:, 1]
        difference = (end - start) * (self.scale / self.difference_scale)
        return torch.cat((start, end, difference), dim=1)


class Classifier(nn.Module):
    """p(class | frames)."""

    def __init__(self, trunk: Trunk, hidden: int, classes: int) -> None:
        super().__init__()
        self.trunk = trunk
        self.head = nn.Linear(hidden, classes)

    def forward(self, frames: Tensor) -> Tensor:
        """Return log probabilities ``(n, classes)`` of frames ``(n, 1 or 2, features)``."""
        return self.log_probabilities(self.trunk(frames))

    def log_probabilities(self, hidden: Tensor) -> Tensor:
        """Return log probabilities ``(n, classes)`` from the trunk's last layer."""
        logits: Tensor = self.head(hidden)
        return logits.log_softmax(dim=-1)

    def loss(self, batch: Examples, generator: torch.Generator) -> Tensor:
        """Return the mean cross entropy."""
        hidden = self.trunk(batch.frames, generator)
        return functional.nll_loss(self.log_probabilities(hidden), batch.labels)


class ParameterNetwork(nn.Module):
    """p(target | frames, primitive): a mixture around linear functions of the frames.

    Each component of a primitive has a line that is fitted before training and sees `inputs`
    of the frames, without noise; the perceptron learns what it leaves over, in units of its spread.
    A target that simply is where the gripper ends is thus exact from the first step. Where a
    primitive can be about one object or another, each has components of its own, and the
    perceptron learns which to choose, among those whose line is for where the frames are: its gate
    says so (see `LinearFit`). How much of what the perceptron says is added to a line, its
    trust, is 1 unless it is measured on data left out. Components may be left out of the mixture
    for a while by `active`, 1 or 0 for each.

    Args:
        trunk: Of the perceptron.
        hidden: Width of the trunk's last layer.
        inputs: What the lines see of frames.
        mask: Which parameters a primitive has, ``(primitives, D)`` bool.
        periods: Of targets, ``(primitives, D)``; 0 for none.
        components: Of the mixture.
        minimum_deviation: Least standard deviation of a component, in targets.
    """

    weight: Tensor
    bias: Tensor
    spread: Tensor
    gate: Tensor
    gate_value: Tensor
    trust: Tensor
    active: Tensor
    mask: Tensor
    periods: Tensor

    def __init__(
        self,
        trunk: Trunk,
        hidden: int,
        inputs: LineInputs,
        mask: Tensor,
        periods: Tensor,
        components: int,
        minimum_deviation: float,
    ) -> None:
        super().__init__()
        primitives, width = mask.shape
        self.trunk = trunk
        self.inputs = inputs
        self._shape = (primitives, components, width)
        self.minimum_deviation = minimum_deviation
        self.head = nn.Linear(hidden, primitives * components * (1 + 2 * width))
        self._start_head()
        self.register_buffer("weight", torch.zeros(*self._shape, inputs.width))
        self.register_buffer("bias", torch.zeros(self._shape))
        self.register_buffer("spread", torch.ones(self._shape))
        self.register_buffer("gate", torch.zeros(primitives, components, inputs.width))
        self.register_buffer("gate_value", torch.zeros(primitives, components))
        self.register_buffer("trust", torch.ones(primitives, width))
        self.register_buffer("active", torch.ones(components), persistent=False)
        self.register_buffer("mask", mask.float())
        self.register_buffer("periods", periods.float(), persistent=False)

    def _start_head(self) -> None:
        """Start at the lines."""
        with torch.no_grad():
            self.head.weight.mul_(0.1)
            self.head.bias.zero_()

    def set_lines(self, primitive: int, lines: Sequence[LinearFit], components: range) -> None:
        """Give components of a primitive their lines.

        Where there are fewer lines than components, they come again, wider each time: wide
        components catch outliers.

        Args:
            primitive: Whose.
            lines: Of the parameters that it has; those beyond the number of components are left
                out.
            components: Which.
        """
        primitives, count, width = self._shape
        bias = self.head.bias.detach().view(primitives, count, 1 + 2 * width)
        for place, component in enumerate(components):
            line = lines[place % len(lines)]
            own = (primitive, component, slice(len(line.bias)))
            self.weight[own], self.bias[own] = line.weight.float(), line.bias.float()
            self.spread[own] = line.spread.clamp_min(self.minimum_deviation).float()
            self.gate[primitive, component] = line.gate.float()
            self.gate_value[primitive, component] = line.gate_value.float()
            bias[primitive, component, 1 + width :] = WIDENING * (place // len(lines))

    def forward(self, frames: Tensor, labels: Tensor) -> Mixture:
        """Return the mixtures of targets.

        Args:
            frames: ``(n, 1 or 2, features)``.
            labels: The primitive of each, ``(n,)``.
        """
        return self.mixture(frames, labels, self.trust)

    def loss(self, batch: Examples, generator: torch.Generator) -> Tensor:
        """Return the mean negative log density, with the perceptron trusted in full."""
        trust = torch.ones_like(self.trust)
        mixture = self.mixture(batch.frames, batch.labels, trust, generator)
        return -log_density(mixture, batch.targets).mean()

    def mixture(
        self,
        frames: Tensor,
        labels: Tensor,
        trust: Tensor,
        generator: torch.Generator | None = None,
    ) -> Mixture:
        """Return the mixtures of targets; see `forward` and `Trunk.forward`.

        Args:
            frames: ``(n, 1 or 2, features)``.
            labels: ``(n,)``.
            trust: In the perceptron, ``(primitives, D)``.
            generator: Of the input noise; None for no noise.
        """
        primitives, components, width = self._shape
        rows = torch.arange(len(labels))
        outputs = self.head(self.trunk(frames, generator))
        outputs = outputs.view(-1, primitives, components, 1 + 2 * width)[rows, labels]
        # All primitives' lines in one product: choosing their weights first would copy them.
        inputs = self.inputs(frames)
        lines = inputs @ self.weight.flatten(0, 2).T
        lines = lines.view(-1, *self._shape)[rows, labels] + self.bias[labels]
        spread = self.spread[labels]
        means = lines + spread * trust[labels][:, None] * outputs[:, :, 1 : 1 + width]
        deviations = spread * functional.softplus(outputs[:, :, 1 + width :])
        deviations = deviations + self.minimum_deviation
        usable = self._usable(inputs, labels)
        logits = outputs[:, :, 0].masked_fill(~usable, -torch.inf)
        return Mixture(logits, means, deviations, self.mask[labels], self.periods[labels])

    def _usable(self, inputs: Tensor, labels: Tensor) -> Tensor:
        """Return which components are in the mixtures: active ones whose gate is open.

        Where none is, as with something held that never was before, all active ones are.

        Args:
            inputs: What the lines see, ``(n, inputs)``.
            labels: ``(n,)``.

        Returns:
            ``(n, components)``.
        """
        primitives, components, _ = self._shape
        sums = (inputs @ self.gate.flatten(0, 1).T).view(-1, primitives, components)
        rows = torch.arange(len(labels))
        differences = sums[rows, labels] - self.gate_value[labels]
        active = (self.active > 0).expand_as(differences)
        usable = active & (differences.abs() < 0.5)
        return torch.where(usable.any(dim=1, keepdim=True), usable, active)

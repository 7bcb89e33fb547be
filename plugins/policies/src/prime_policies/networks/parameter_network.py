"""p(parameters | what is seen, primitive): a task-parameterised mixture for each primitive."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import torch
from torch import Tensor, nn

from prime_policies.networks.mixture import Mixture, log_density, wrapped
from prime_policies.networks.network import Batch, Network
from prime_policies.networks.product_mixture import ProductMixture
from prime_policies.networks.starting import start_components
from prime_policies.networks.trunk import Trunk

AT_TARGET = 0.02  # over the scales, some mm: an arm misses by 1 mm, a hand that has left by 3 cm
RIDGES = (1e-5, 1e-3, 1e-1, 10.0)  # for inputs of unit spread; the last leaves a constant


class ParameterNetwork(Network):
    """The mixtures of all primitives, whose components one trunk weighs."""

    def __init__(self, trunk: Trunk, mixtures: Sequence[ProductMixture]) -> None:
        super().__init__()
        self.trunk = trunk
        self.mixtures = nn.ModuleList(mixtures)

    def forward(self, features: Tensor, poses: Tensor, primitive: int) -> Mixture:
        """Return the mixtures of a primitive's targets, over its scales.

        Args:
            features: ``(n, 1 or 2, features)``.
            poses: Frames of reference, ``(n, frames, 4)``.
            primitive: Its number.
        """
        mixture = self.mixtures[primitive]
        return mixture(self.trunk(features), poses, self.trunk.inputs(features))

    def loss(self, batch: Batch, generator: torch.Generator) -> Tensor:
        """Return the mean negative log density of the targets."""
        hidden, inputs = self.trunk(batch.features, generator), self.trunk.inputs(batch.features)
        total = hidden.new_zeros(())
        for mixture, rows, targets in self._by_primitive(batch):
            found = mixture(hidden[rows], batch.poses[rows], inputs[rows])
            total = total - log_density(found, targets).sum()
        return total / len(batch.labels)

    def start(
        self, batch: Batch, components: Iterable[int], generator: np.random.Generator
    ) -> None:
        """Start some components where examples gather, of each primitive that has any.

        Those of which all parameters are known.
        """
        batch = Batch(*(part[~batch.targets.isnan().any(dim=1)] for part in batch))
        inputs = self.trunk.inputs(batch.features)
        for mixture, rows, targets in self._by_primitive(batch):
            poses = batch.poses[rows]
            start_components(mixture, components, poses, inputs[rows], targets, generator)

    def activate(self, components: Iterable[int]) -> None:
        """Let some components take part, and no others."""
        for mixture in self.mixtures:
            mixture.active.fill_(0.0)[list(components)] = 1.0

    def fit_affine(self, batch: Batch) -> None:
        """Fit each primitive's affine map: what the gripper's pose at s' misses the targets by.

        An arm's controller stops short by a millimetre, in a way that follows from where it is.
        Examples whose gripper has left the target by s' say nothing of that: they are left out,
        unless they are the greater part, as those of pushes are. Then all are fitted.
        """
        inputs = self.trunk.inputs(batch.features).double()
        for mixture, rows, targets in self._by_primitive(batch):
            rest = targets - mixture.end_of(batch.poses[rows])
            rest = wrapped(rest, mixture.periods / mixture.scales).double()
            fitted = rest.abs().amax(dim=1) < AT_TARGET
            if fitted.sum() <= len(fitted) / 2:
                fitted[:] = True
            mixture.affine.copy_(ridge_regression(inputs[rows][fitted], rest[fitted]))

    def _by_primitive(self, batch: Batch) -> Iterator[tuple[ProductMixture, Tensor, Tensor]]:
        """Yield mixture, rows and targets over its scales of each primitive that has examples."""
        for number, mixture in enumerate(self.mixtures):
            rows = batch.labels == number
            if rows.any():
                yield mixture, rows, batch.targets[rows, : len(mixture.scales)] / mixture.scales


def ridge_regression(inputs: Tensor, targets: Tensor) -> Tensor:
    """Fit an affine map of inputs ``(n, inputs)`` to targets ``(n, D)``.

    Of some ridges it has the one that predicts examples best that are left out. Returned are the
    constant and the coefficients of each target, ``(D, 1 + inputs)``.
    """
    mean, middle = inputs.mean(dim=0), targets.mean(dim=0)
    centred, rest = inputs - mean, targets - middle
    values, vectors = torch.linalg.eigh(centred.T @ centred / len(inputs))
    turned = centred @ vectors
    projected = turned.T @ rest / len(inputs)
    best, least = vectors.new_zeros(len(values), targets.shape[1]), torch.inf
    for ridge in RIDGES:
        shrunk = 1.0 / (values.clamp_min(0.0) + ridge)
        weights = shrunk[:, None] * projected
        # Residuals as if each example had been left out (Allen, 1974).
        leverage = (turned.square() * shrunk).sum(dim=1) / len(inputs) + 1.0 / len(inputs)
        errors = (rest - turned @ weights) / (1.0 - leverage).clamp_min(1e-3)[:, None]
        error = float(errors.abs().median(dim=0).values.sum())
        if error < least:
            best, least = vectors @ weights, error
    return torch.cat(((middle - mean @ best)[:, None], best.T), dim=1).float()

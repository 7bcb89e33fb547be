"""p(parameters | what is seen, primitive): a task-parameterised mixture for each primitive."""

from collections.abc import Iterable, Sequence

import numpy as np
import torch
from torch import Tensor, nn

from prime_policies.networks.batch import Batch
from prime_policies.networks.mixture import Mixture, log_density, wrapped
from prime_policies.networks.product_mixture import ProductMixture
from prime_policies.networks.starting import start_components
from prime_policies.networks.trunk import Trunk

RIDGE = 1e-4  # of the affine map, relative to inputs of unit spread: some inputs are the same


class ParameterNetwork(nn.Module):
    """The mixtures of all primitives, whose components one trunk weighs.

    Args:
        trunk: Sees the features.
        mixtures: Of the primitives.
    """

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
        mixture: Mixture = self.mixtures[primitive](
            self.trunk(features), poses, self.trunk.inputs(features)
        )
        return mixture

    def loss(self, batch: Batch, generator: torch.Generator) -> Tensor:
        """Return the mean negative log density of the targets."""
        hidden, inputs = self.trunk(batch.features, generator), self.trunk.inputs(batch.features)
        total = hidden.new_zeros(())
        for number, mixture in enumerate(self.mixtures):
            rows = batch.labels == number
            if rows.any():
                width = len(mixture.scales)
                targets = batch.targets[rows, :width] / mixture.scales
                found = mixture(hidden[rows], batch.poses[rows], inputs[rows])
                total = total - log_density(found, targets).sum()
        return total / len(batch.labels)

    @torch.no_grad()
    def start(
        self, batch: Batch, components: Iterable[int], generator: np.random.Generator
    ) -> None:
        """Start components where examples gather, of each primitive that has any.

        Args:
            batch: The examples.
            components: Numbers of the components.
            generator: Of the examples that are looked at.
        """
        inputs = self.trunk.inputs(batch.features)
        for number, mixture in enumerate(self.mixtures):
            rows = batch.labels == number
            if rows.any():
                targets = batch.targets[rows, : len(mixture.scales)] / mixture.scales
                start_components(
                    mixture, components, batch.poses[rows], inputs[rows], targets, generator
                )

    @torch.no_grad()
    def fit_affine(self, batch: Batch) -> None:
        """Fit each primitive's affine map by ridge regression.

        Angles are fitted as turns from the gripper's yaw, which the map is then added to.
        """
        inputs = self.trunk.inputs(batch.features).double()
        for number, mixture in enumerate(self.mixtures):
            rows = batch.labels == number
            if rows.any():
                targets = batch.targets[rows, : len(mixture.scales)] / mixture.scales
                rest = targets - mixture.turn_base(batch.poses[rows])
                rest = wrapped(rest, mixture.periods / mixture.scales)
                mixture.affine.copy_(_ridge(inputs[rows], rest.double()))


def _ridge(inputs: Tensor, targets: Tensor) -> Tensor:
    """Return constant and coefficients of each target, ``(D, 1 + inputs)``."""
    mean, middle = inputs.mean(dim=0), targets.mean(dim=0)
    centred = inputs - mean
    square = centred.T @ centred / len(inputs)
    square += RIDGE * torch.eye(len(square), dtype=square.dtype)
    weights = torch.linalg.solve(square, centred.T @ (targets - middle) / len(inputs)).T
    return torch.cat(((middle - weights @ mean)[:, None], weights), dim=1).float()

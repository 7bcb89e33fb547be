"""A classifier of instants or pairs of them."""

import torch
from torch import Tensor, nn
from torch.nn import functional

from prime_policies.networks.network import Batch, Network
from prime_policies.networks.trunk import Trunk


class Classifier(Network):
    """p(class | features), for a number of classes."""

    def __init__(self, trunk: Trunk, classes: int) -> None:
        super().__init__()
        self.trunk = trunk
        self.head = nn.Linear(trunk.width, classes)

    def forward(self, features: Tensor) -> Tensor:
        """Return log probabilities ``(n, classes)`` of features ``(n, 1 or 2, features)``."""
        return self.log_probabilities(self.trunk(features))

    def log_probabilities(self, hidden: Tensor) -> Tensor:
        """Return log probabilities ``(n, classes)`` from the trunk's last layer."""
        return functional.log_softmax(self.head(hidden), dim=-1)

    def loss(self, batch: Batch, generator: torch.Generator) -> Tensor:
        """Return the mean cross entropy."""
        hidden = self.trunk(batch.features, generator)
        return functional.nll_loss(self.log_probabilities(hidden), batch.labels)

"""The networks that skills are learnt with: a variational autoencoder of sub-trajectories.

What a skill is, is told by its latent. Beside the actions that it stands for, three things shape
it: sub-trajectories that begin near each other are alike (slowness), where one begins and ends
tells it (skill inverse dynamics), and two of them tell how far apart they begin (temporal
distance).
"""

from itertools import pairwise
from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional

from prime_policies.motor.bc_rnn import Memory
from prime_policies.motor.scaling import Scaling
from prime_policies.networks.network import Network
from prime_policies.sailor.settings import SkillSettings
from prime_policies.sailor.skill_examples import SkillBatch

LOG_VARIANCES = (-10.0, 4.0)
"""Least and greatest that are told; what an exponential makes of others is no use."""


def perceptron(inputs: int, hidden: tuple[int, ...], outputs: int) -> nn.Sequential:
    """Return a perceptron with rectifiers between its layers."""
    layers: list[nn.Module] = []
    for before, after in pairwise((inputs, *hidden, outputs)):
        layers += [nn.Linear(before, after), nn.ReLU()]
    return nn.Sequential(*layers[:-1])


class Gaussian(NamedTuple):
    """Distributions of latents with independent numbers.

    Attributes:
        mean: ``(n, latent)``.
        log_variance: ``(n, latent)``.
    """

    mean: Tensor
    log_variance: Tensor

    @classmethod
    def of(cls, numbers: Tensor) -> "Gaussian":
        """Return what a network tells, ``(n, 2 latent)``, as distributions."""
        mean, log_variance = numbers.chunk(2, dim=-1)
        return cls(mean, log_variance.clamp(*LOG_VARIANCES))

    def draw(self, generator: torch.Generator) -> Tensor:
        """Draw a latent of each, ``(n, latent)``."""
        noise = torch.randn(self.mean.shape, generator=generator).to(self.mean.device)
        return self.mean + (0.5 * self.log_variance).exp() * noise

    def divergence(self, other: "Gaussian") -> Tensor:
        """Return the Kullback-Leibler divergence from others, ``(n,)``."""
        difference = self.log_variance - other.log_variance
        away = (self.mean - other.mean).square() / other.log_variance.exp()
        return 0.5 * (difference.exp() + away - 1 - difference).sum(dim=-1)


class SkillEncoder(nn.Module):
    """p(latent | what was seen and done in a sub-trajectory), normalised."""

    def __init__(self, features: int, actions: int, settings: SkillSettings) -> None:
        super().__init__()
        hidden = settings.hidden
        self.recurrent = nn.LSTM(features + actions, hidden, settings.layers, batch_first=True)
        self.head = perceptron(hidden, settings.hidden_sizes, 2 * settings.latent)

    def forward(self, seen: Tensor, done: Tensor) -> Gaussian:
        """Return the latents of ``(n, T, features)`` and ``(n, T, A)``."""
        hidden, _ = self.recurrent(torch.cat((seen, done), dim=-1))
        return Gaussian.of(self.head(hidden[:, -1]))


class SkillDecoder(nn.Module):
    """The actions of a skill, each from what is seen by then, normalised."""

    def __init__(self, features: int, actions: int, settings: SkillSettings) -> None:
        super().__init__()
        inputs, hidden = features + settings.latent, settings.hidden
        self.recurrent = nn.LSTM(inputs, hidden, settings.layers, batch_first=True)
        self.head = perceptron(hidden, settings.hidden_sizes, actions)

    def forward(
        self, seen: Tensor, latents: Tensor, memory: Memory | None = None
    ) -> tuple[Tensor, Memory]:
        """Return the actions, and the memory after the last one.

        Args:
            seen: ``(n, T, features)``.
            latents: ``(n, latent)``.
            memory: Of the steps before; None where there are none.

        Returns:
            Actions ``(n, T, A)`` and the memory.
        """
        repeated = latents[:, None].expand(-1, seen.shape[1], -1)
        hidden, memory = self.recurrent(torch.cat((seen, repeated), dim=-1), memory)
        return self.head(hidden), memory


class SkillModel(Network):
    """All that is trained on the rollouts.

    Args:
        features: Numbers of an instant.
        actions: Numbers of an action.
        settings: How large it is, and what its losses weigh.

    Attributes:
        scaling: Of features and actions.
        encoder: Tells latents of sub-trajectories.
        decoder: Tells actions of latents.
    """

    def __init__(self, features: int, actions: int, settings: SkillSettings) -> None:
        super().__init__()
        self._settings, latent, ends = settings, settings.latent, 2 * features
        self.scaling = Scaling(features, actions)
        self.encoder = SkillEncoder(features, actions, settings)
        self.decoder = SkillDecoder(features, actions, settings)
        self.prior = perceptron(ends, settings.hidden_sizes, 2 * latent)
        self.inverse_dynamics = perceptron(ends, settings.hidden_sizes, latent)
        self.distance = perceptron(2 * latent, settings.distance_hidden_sizes, 1)

    def rate_share(self, weight: str) -> float:
        """Return the share of the learning rate: that of the two predictors is their own."""
        if weight.startswith(("inverse_dynamics.", "distance.")):
            return self._settings.predictors_learning_rate / self._settings.learning_rate
        return 1.0

    def latents(self, features: Tensor, actions: Tensor) -> Gaussian:
        """Return the latents of sub-trajectories.

        Args:
            features: ``(n, T, features)``.
            actions: In their own units, ``(n, T, A)``.
        """
        return self.encoder(self.scaling.inputs(features), self.scaling.targets(actions))

    def loss(self, batch: SkillBatch, generator: torch.Generator) -> Tensor:
        """Return the mean of all losses, weighed; the noise is that of the latents."""
        settings, seen = self._settings, self.scaling.inputs(batch.features)
        done = self.scaling.targets(batch.actions)
        found = self.encoder(seen, done)
        decoded, _ = self.decoder(seen, found.draw(generator))
        ends = torch.cat((seen[:, 0], seen[:, -1]), dim=-1)
        prior = Gaussian.of(self.prior(ends))
        later = self.latents(batch.later_features, batch.later_actions).mean
        differences = (later - found.mean).square().mean(dim=-1)
        near = (batch.distances <= settings.near).float()
        slowness = (near * differences).sum() / near.sum().clamp_min(1.0)
        distances = self.distance(torch.cat((found.mean, later), dim=-1))[:, 0]
        return (
            functional.mse_loss(decoded, done)
            + settings.divergence_weight * found.divergence(prior).mean()
            + settings.slowness_weight * slowness
            + settings.inverse_dynamics_weight
            * functional.mse_loss(self.inverse_dynamics(ends), found.mean)
            + settings.distance_weight * functional.mse_loss(distances, batch.distances)
        )

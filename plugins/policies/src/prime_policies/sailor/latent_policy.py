"""The network of ``sailor`` that says which skill comes next, and the decoder that does it."""

import torch
from torch import Tensor, nn
from torch.nn import functional

from prime_policies.motor.scaling import Scaling
from prime_policies.networks.network import Network
from prime_policies.sailor.latent_examples import LatentBatch
from prime_policies.sailor.settings import SailorSettings
from prime_policies.sailor.skill_model import SkillDecoder, SkillModel


class LatentPolicy(Network):
    """The next skill's latent from the last instants; and a decoder of latents, not trained here.

    Args:
        features: Numbers of an instant.
        actions: Numbers of an action.
        settings: How large it is.

    Attributes:
        scaling: Of features and actions.
        decoder: Of latents.
    """

    def __init__(self, features: int, actions: int, settings: SailorSettings) -> None:
        super().__init__()
        self.scaling = Scaling(features, actions)
        self.decoder = SkillDecoder(features, actions, settings.skills).requires_grad_(False)
        self.recurrent = nn.LSTM(features + 1, settings.hidden, settings.layers, batch_first=True)
        self.head = nn.Linear(settings.hidden, settings.skills.latent)

    def take(self, skills: SkillModel) -> None:
        """Take the scaling and the decoder of trained skills."""
        self.scaling.load_state_dict(skills.scaling.state_dict())
        self.decoder.load_state_dict(skills.decoder.state_dict())

    def forward(self, features: Tensor, shown: Tensor) -> Tensor:
        """Return the latents of the skills that come next, ``(n, latent)``.

        Args:
            features: Of the last instants, ``(n, history, features)``.
            shown: 1 where demonstrations are followed, 0 where rollouts are, ``(n,)``.
        """
        source = shown[:, None, None].expand(-1, features.shape[1], 1)
        hidden, _ = self.recurrent(torch.cat((self.scaling.inputs(features), source), dim=-1))
        return self.head(hidden[:, -1])

    def loss(self, batch: LatentBatch, generator: torch.Generator) -> Tensor:
        """Return the mean squared error of the latents; there is no noise."""
        return functional.mse_loss(self(batch.features, batch.shown), batch.latents)

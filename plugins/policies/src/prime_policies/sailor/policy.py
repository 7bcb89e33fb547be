"""The policy ``sailor`` at work."""

from collections import deque

import numpy as np
import torch
from torch import Tensor

from prime_core.contracts.environment import Action
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import MotorPolicy
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.bc_rnn import Memory
from prime_policies.sailor.latent_policy import LatentPolicy
from prime_policies.sailor.settings import SailorSettings
from prime_policies.training.repeatable import threads


class SailorPolicy(MotorPolicy):
    """A trained policy that picks a skill and does it, step by step, until it picks the next.

    It draws nothing: the same episode has the same actions.

    Args:
        network: Trained.
        encoder: Of what is seen.
        settings: How many instants it sees, and how many steps a skill has.
    """

    def __init__(
        self, network: LatentPolicy, encoder: FeatureEncoder, settings: SailorSettings
    ) -> None:
        self._network, self._encoder = network, encoder
        self._history, self._steps = settings.history, settings.skills.steps
        self.reset(np.random.default_rng(0))

    def reset(self, generator: np.random.Generator) -> None:
        """Forget the episode before; see `MotorPolicy`."""
        self._seen: deque[Tensor] = deque(maxlen=self._history)
        self._latent: Tensor | None = None
        self._memory: Memory | None = None
        self._left = 0  # steps of the skill

    @threads()
    @torch.inference_mode()
    def act(self, seen: Observations) -> Action:
        """Do the next step of the skill; see `MotorPolicy`."""
        features = torch.from_numpy(self._encoder.encode(seen))
        # As in training, the first instant stands for those before it.
        self._seen.extend([features] * (1 if self._seen else self._history))
        network = self._network
        if self._latent is None or not self._left:
            self._latent = network(torch.stack([*self._seen], dim=1), torch.ones(1))
            self._memory, self._left = None, self._steps
        self._left -= 1
        inputs = network.scaling.inputs(features)[:, None]
        decoded, self._memory = network.decoder(inputs, self._latent, self._memory)
        return network.scaling.actions(decoded[0, 0]).double().numpy()

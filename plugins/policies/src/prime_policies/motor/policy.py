"""The policy ``bc-rnn`` at work."""

import numpy as np
import torch

from prime_core.contracts.environment import Action
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import MotorPolicy
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.bc_rnn import BcRnn, Memory
from prime_policies.networks.mixture import draw
from prime_policies.training.repeatable import threads

DEVIATION = 1e-4
"""Of the Gaussians that actions are drawn from, normalised: robomimic's evaluation with low noise.
What is drawn is the component."""


class BcRnnPolicy(MotorPolicy):
    """A trained network that forgets what was before after each window.

    Args:
        network: Trained.
        encoder: Of what is seen.
        horizon: Steps of a window.
    """

    def __init__(self, network: BcRnn, encoder: FeatureEncoder, horizon: int) -> None:
        self._network, self._encoder, self._horizon = network, encoder, horizon
        self.reset(np.random.default_rng(0))

    def reset(self, generator: np.random.Generator) -> None:
        """Forget the episode before; see `MotorPolicy`."""
        self._generator, self._steps = generator, 0
        self._memory: Memory | None = None

    @threads()
    @torch.inference_mode()
    def act(self, seen: Observations) -> Action:
        """Draw the next motor action; see `MotorPolicy`."""
        if self._steps % self._horizon == 0:
            self._memory = None
        self._steps += 1
        features = torch.from_numpy(self._encoder.encode(seen))[:, None]
        mixture, self._memory = self._network(features, self._memory)
        calm = mixture._replace(deviations=torch.full_like(mixture.means[0], DEVIATION))
        (drawn,) = draw(calm, 1, self._generator)
        return self._network.scaling.actions(drawn).double().numpy()

"""A policy of LeRobot's at work."""

import numpy as np
import torch

from prime_core.contracts.environment import Action
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import MotorPolicy
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.lerobot.network import LeRobotNetwork
from prime_policies.training.repeatable import threads


class LeRobotPolicy(MotorPolicy):
    """Does what LeRobot's ``select_action`` says, which plans several actions at once.

    Args:
        network: Trained.
        encoder: Of what is seen.
    """

    def __init__(self, network: LeRobotNetwork, encoder: FeatureEncoder) -> None:
        self._network, self._encoder = network.eval(), encoder
        self.reset(np.random.default_rng(0))

    def reset(self, generator: np.random.Generator) -> None:
        """Forget what was seen and planned in the episode before; see `MotorPolicy`."""
        self._generator = generator
        self._network.forget()

    @threads()
    @torch.inference_mode()
    def act(self, seen: Observations) -> Action:
        """Return the next planned action; see `MotorPolicy`."""
        features = torch.from_numpy(self._encoder.encode(seen))
        action = self._network.act(features, int(self._generator.integers(2**62)))
        return action.double().numpy()

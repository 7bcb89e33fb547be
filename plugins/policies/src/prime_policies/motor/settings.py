"""Settings of policies over motor actions, and of their training."""

import math
from typing import Any

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer

from prime_core.configuration import Count
from prime_policies.training.settings import TrainingSettings, Width


class MotorTrainingSettings(TrainingSettings):
    """How long a network is trained on windows of episodes, and when it is kept."""

    epochs: Count
    """Epochs on the demonstrations."""
    pretraining_epochs: Count
    """Epochs on the rollouts before them, where the policy is pretrained."""
    checkpoints: int = Field(10, ge=1, le=1000)
    """Kept after epochs on the demonstrations that are evenly apart, the last one among them; after
    each where there are fewer epochs."""

    @property
    def kept_epochs(self) -> list[int]:
        """Numbers of finished epochs after which the policy is kept, in order."""
        count = min(self.checkpoints, self.epochs)
        return [-(-self.epochs * number // count) for number in range(1, count + 1)]


class BcRnnSettings(MotorTrainingSettings):
    """How large the network is, and how it is trained: as robomimic's BC-RNN on object poses."""

    hidden: Width = 400
    """Units of each recurrent layer."""
    layers: int = Field(2, ge=1, le=16)
    """Recurrent layers."""
    horizon: int = Field(10, ge=1, le=1000)
    """Steps of a window; at work the recurrent state is forgotten after as many."""
    components: int = Field(5, ge=1, le=64)
    """Gaussians in the mixture of actions."""
    minimum_deviation: float = Field(1e-4, ge=1e-6, le=1)
    """Least standard deviation of a Gaussian, of actions normalised to [-1, 1]."""

    batch_size: int = Field(100, ge=1, le=16_384)
    """Windows of a step."""
    learning_rate: float = Field(1e-4, ge=1e-9, le=1)
    """Of Adam at the start."""
    constant_rate: bool = False
    """Whether the learning rate stays as it is, as robomimic's does; else it falls to zero by half
    a cosine."""
    cuts_gradients: bool = True
    """Whether gradients longer than 10 are cut to that. robomimic's are not, and are longer by far
    once a mixture is narrow: uncut, the likelihood rises faster (docs/robomimic.md)."""
    weight_decay: float = Field(0.0, ge=0, le=1)
    """None, as in robomimic."""
    steps_per_epoch: Count = 250
    """Steps of an epoch (robomimic: 100); an interrupted training goes on after its last one."""
    epochs: Count = 20
    """Epochs on the demonstrations (robomimic: 2000 of 100 steps, which are eleven hours of one
    core): 0.2 s a step, so that a seed takes a quarter of an hour."""
    pretraining_epochs: Count = 20
    """Epochs on the rollouts before them, where the policy is pretrained: another quarter."""

    @property
    def gradient_limit(self) -> float:
        """Norm that longer gradients are cut to; see `TrainingSettings`."""
        return super().gradient_limit if self.cuts_gradients else math.inf

    def share_of_rate(self, step: int, steps: int) -> float:
        """Return the share of the learning rate at one of some steps; see `TrainingSettings`."""
        return 1.0 if self.constant_rate else super().share_of_rate(step, steps)

    @model_serializer(mode="wrap")
    def _as_before(self, plain: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out later keys where they change nothing: weights of before are still these."""
        found: dict[str, Any] = plain(self)
        usual = {"constant_rate": False, "cuts_gradients": True}
        return {key: value for key, value in found.items() if usual.get(key) is not value}

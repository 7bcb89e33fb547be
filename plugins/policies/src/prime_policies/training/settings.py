"""Settings that all networks share, and those of their training."""

import math
from typing import Annotated, ClassVar

from pydantic import Field

from prime_core.configuration import Config, Count, Share
from prime_core.contracts.training import TrainableConfig

GRADIENT_LIMIT = 10.0  # one strange batch must not undo a training
Width = Annotated[int, Field(ge=1, le=8192)]


class TrainingSettings(Config):
    """How a step of a training goes, and how many steps an epoch has."""

    batch_size: int = Field(256, ge=1, le=16_384)
    """Examples of a step."""
    steps_per_epoch: Count = 500
    """Steps of an epoch; an interrupted training goes on after its last finished epoch."""
    learning_rate: float = Field(1e-3, ge=1e-9, le=1)
    """Of AdamW at the start; it falls to zero by half a cosine."""
    weight_decay: Share = 1e-3
    """Decoupled, of AdamW; offsets and precisions of mixtures have none."""

    @property
    def gradient_limit(self) -> float:
        """Norm that longer gradients are cut to."""
        return GRADIENT_LIMIT

    def share_of_rate(self, step: int, steps: int) -> float:
        """Return the share of the learning rate at one of some steps, counted from 0."""
        return 0.5 * (1 + math.cos(math.pi * step / steps))


class TorchTrainable(TrainableConfig):
    """Settings of what torch trains."""

    def check_device(self, device: str) -> None:
        """Ask torch for it; see `TrainableConfig`."""
        from prime_policies.training.devices import torch_device

        torch_device(device)


class NetworkSettings(TorchTrainable, TrainingSettings):
    """How large the networks are, and how a step of their training goes."""

    kind: ClassVar[str]  # name that the settings are registered under
    version: ClassVar[int]  # of weights; rises when older ones would mean something else
    pair: ClassVar[bool]  # whether the networks see pairs of instants, or single ones

    hidden_sizes: tuple[Width, ...] = Field((256, 256), min_length=1, max_length=16)
    """Widths of the hidden layers. (1024, 1024), as in the paper, was no better on states."""
    components: int = Field(12, ge=1, le=64)
    """Gaussians in a mixture of parameters."""
    minimum_deviation: float = Field(1e-3, ge=1e-4, le=1)
    """Least standard deviation of a Gaussian, of parameters normalised to [-1, 1]."""
    input_noise: float = Field(0.05, ge=0, le=10)
    """Standard deviation of the noise on normalised inputs while training."""

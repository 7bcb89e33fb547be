"""What the policy ``prime`` may be told."""

from pydantic import Field

from prime_core.configuration import Count
from prime_policies.training.settings import NetworkSettings


class PrimePolicySettings(NetworkSettings):
    """How its two networks are pretrained and fine-tuned."""

    components: int = Field(12, ge=2, le=64)
    """Gaussians in a mixture of parameters. With pretraining, half of them start where parameters
    of rollouts gather, half where those of demonstrations do."""
    minimum_deviation: float = Field(0.02, ge=1e-4, le=1)
    """Least standard deviation of a Gaussian, of parameters normalised to [-1, 1]: about what the
    parameters of parsed demonstrations are known to. With less, components learn by heart."""
    pretraining_epochs: Count = 8
    """Epochs of each network on the rollouts."""
    finetuning_epochs: int = Field(10, ge=1, le=1000)
    """Epochs of each network on the demonstrations; a checkpoint is kept after each."""
    finetuning_steps_per_epoch: Count = 200
    """Steps of an epoch on the demonstrations."""

"""What the inverse dynamics model ``mlp-gmm`` may be told."""

from pydantic import Field

from prime_policies.training.settings import NetworkSettings


class MlpGmmSettings(NetworkSettings):
    """How its two networks are trained."""

    classifier_epochs: int = Field(12, ge=1)
    """Epochs of the classifier."""
    parameter_epochs: int = Field(12, ge=1)
    """Epochs of the mixture."""

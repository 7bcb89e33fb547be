"""What the inverse dynamics model ``mlp-gmm`` may be told."""

from prime_core.configuration import Count
from prime_policies.training.settings import NetworkSettings


class MlpGmmSettings(NetworkSettings):
    """How its two networks are trained."""

    classifier_epochs: Count = 12
    """Epochs of the classifier."""
    parameter_epochs: Count = 12
    """Epochs of the mixture."""

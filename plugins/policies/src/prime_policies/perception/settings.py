"""Settings of the network that tells object poses from images."""

from pydantic import Field

from prime_core.configuration import Count
from prime_core.registry.fields import EncoderChoice
from prime_policies.encoders.config import SmallCnnConfig
from prime_policies.training.settings import TrainingSettings


class PoseNetworkSettings(TrainingSettings):
    """How large the network is, and how it is trained."""

    encoder: EncoderChoice = SmallCnnConfig()
    """Of the images, one for each camera: ``resnet18`` as in the paper, where there is a GPU."""
    crop: int = Field(76, ge=8, le=2048)
    """Height and width of the part of an image that is seen [pixels]: anywhere in training, the
    centre at work (paper: 84 to 76)."""
    hidden: int = Field(256, ge=1, le=8192)
    """Units of the layer behind the encoders."""
    epochs: Count = 20
    """Epochs on all frames that have images."""
    steps_per_epoch: Count = 250
    """Steps of an epoch; an interrupted training goes on after its last finished epoch."""
    batch_size: int = Field(64, ge=1, le=16_384)
    """Instants of a step."""

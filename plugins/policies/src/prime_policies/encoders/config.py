"""What is registered as ``resnet18`` and ``small-cnn``."""

from typing import TYPE_CHECKING

from pydantic import Field

from prime_core.contracts.images import EncoderConfig

if TYPE_CHECKING:
    from prime_policies.encoders.keypoints import KeypointEncoder


class KeypointEncoderConfig(EncoderConfig):
    """Settings of encoders that tell where things are in a picture, by a spatial softmax."""

    keypoints: int = Field(32, ge=1, le=1024)
    """Points found in a picture, each by a map of its own."""
    features: int = Field(64, ge=1, le=8192)
    """Numbers that are told of a picture, made of the points."""


class Resnet18Config(KeypointEncoderConfig):
    """ResNet-18, not pretrained, as in the paper."""

    def build(self, height: int, width: int) -> "KeypointEncoder":
        """Make the network; see `EncoderConfig`."""
        from prime_policies.encoders.keypoints import KeypointEncoder
        from prime_policies.encoders.resnet18 import CHANNELS, resnet18

        return KeypointEncoder(resnet18(), CHANNELS, self.keypoints, self.features)


class SmallCnnConfig(KeypointEncoderConfig):
    """Four convolutions: more than six times as fast as ResNet-18."""

    def build(self, height: int, width: int) -> "KeypointEncoder":
        """Make the network; see `EncoderConfig`."""
        from prime_policies.encoders.keypoints import KeypointEncoder
        from prime_policies.encoders.small_cnn import CHANNELS, small_cnn

        return KeypointEncoder(small_cnn(), CHANNELS, self.keypoints, self.features)

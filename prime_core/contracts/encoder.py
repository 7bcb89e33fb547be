"""The contract of an encoder of images: a part of models that see them."""

from abc import abstractmethod
from typing import TYPE_CHECKING

from prime_core.configuration import Config

if TYPE_CHECKING:  # models may compute with what they like: the core needs no torch
    from torch import nn


class EncoderConfig(Config):
    """Settings of an encoder of images; what packs register.

    A model builds one for each camera and trains it together with the rest of the model.
    """

    @abstractmethod
    def build(self, height: int, width: int) -> "nn.Module":
        """Make the network; its first weights come from torch's global generator.

        Args:
            height: Of the pictures that it is given, which may be crops [pixels].
            width: Likewise.

        Returns:
            A module that turns pictures of one camera, ``(n, 3, height, width)`` float32 in
            [0, 1], into features ``(n, F)`` float32. Its attribute ``width`` is ``F``. In
            evaluation mode a picture's features depend on that picture and on ``state_dict()``
            alone. Weights that are not to be learnt require no gradient.
        """

"""Where things are in a picture: a spatial softmax behind convolutions."""

import torch
from torch import Tensor, nn

CHANNELS = 16
"""Of a group that is normalised together. Batches of a robot's frames are small and much alike,
and at work there is one frame: statistics of a batch (BatchNorm) would be those of other data."""


def group_norm(channels: int) -> nn.GroupNorm:
    """Return the normalisation of all encoders here."""
    return nn.GroupNorm(channels // CHANNELS, channels)


class SpatialSoftmax(nn.Module):
    """The expected place of each map's weight, x and y in [-1, 1] from the upper left."""

    def forward(self, maps: Tensor) -> Tensor:
        """Return points ``(n, maps, 2)`` of maps ``(n, maps, H, W)``."""
        weights = maps.flatten(2).softmax(dim=-1).view_as(maps)
        places = [torch.linspace(-1, 1, size, device=maps.device) for size in maps.shape[2:]]
        x = (weights.sum(dim=2) * places[1]).sum(dim=-1)
        y = (weights.sum(dim=3) * places[0]).sum(dim=-1)
        return torch.stack((x, y), dim=-1)


class KeypointEncoder(nn.Module):
    """Convolutions, a map for each point, the points, features made of them linearly.

    Args:
        convolutions: From pictures ``(n, 3, H, W)`` of any size to smaller maps.
        channels: Number of these maps.
        keypoints: How many.
        features: How many.

    Attributes:
        width: Number of features.
    """

    def __init__(
        self, convolutions: nn.Module, channels: int, keypoints: int, features: int
    ) -> None:
        super().__init__()
        self.width = features
        self.convolutions = convolutions
        self.maps = nn.Conv2d(channels, keypoints, 1)
        self.points = SpatialSoftmax()
        self.head = nn.Linear(2 * keypoints, features)

    def forward(self, pictures: Tensor) -> Tensor:
        """Return features ``(n, width)`` of pictures ``(n, 3, H, W)`` in [0, 1]."""
        maps = self.maps(self.convolutions(2 * pictures - 1))
        # In full precision, also where the convolutions are not: points are to be told apart.
        with torch.autocast(pictures.device.type, enabled=False):
            return self.head(self.points(maps.float()).flatten(1))

"""Four convolutions."""

from torch import nn

from prime_policies.encoders.keypoints import group_norm

LAYERS = ((32, 2), (32, 2), (64, 2), (64, 1))
"""Channels and stride of each: of 76 x 76 pixels 10 x 10 places are left."""

CHANNELS = LAYERS[-1][0]


def small_cnn() -> nn.Sequential:
    """Return the convolutions, from pictures to maps."""
    layers: list[nn.Module] = []
    before = 3
    for channels, stride in LAYERS:
        convolution = nn.Conv2d(before, channels, 3, stride, padding=1, bias=False)
        layers += [convolution, group_norm(channels), nn.ReLU()]
        before = channels
    return nn.Sequential(*layers)

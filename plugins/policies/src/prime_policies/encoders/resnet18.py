"""The convolutions of ResNet-18."""

from torch import nn
from torchvision.models import resnet

from prime_policies.encoders.keypoints import group_norm

CHANNELS = 512
"""Of the last stage."""


def resnet18() -> nn.Sequential:
    """Return torchvision's, not pretrained, from pictures to maps.

    The last stage has no stride: of 76 x 76 pixels 5 x 5 places are left, where 3 x 3 would tell
    little of where things are.
    """
    network = resnet.resnet18(weights=None, norm_layer=group_norm)
    first = network.layer4[0]
    for convolution in (first.conv1, first.downsample[0]):
        convolution.stride = (1, 1)
    return nn.Sequential(*list(network.children())[:-2])  # less the pooling and the classes

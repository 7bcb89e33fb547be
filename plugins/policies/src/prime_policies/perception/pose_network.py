"""Object poses from images and robot state."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from prime_core.contracts.description import ObjectDescription
from prime_core.contracts.observations import OBJECT_WIDTH, Observations
from prime_core.rotations import yaw_of
from prime_policies.encoders.crops import crop
from prime_policies.networks.network import Network
from prime_policies.training.devices import precision

YAW_WEIGHT, HELD_WEIGHT = 0.3, 0.1
"""In the loss, of a position 1: places are what most parameters follow from."""
LINEAR_FROM = 0.1
"""Of a position's miss, over the spread of positions: beyond it the loss grows with the miss, not
its square. With 1, misses of centimetres hardly count: after 1,000 steps on PickPlace 15 mm in the
median, where they are 10 mm with this."""
LEAST_SPREAD = 1e-3  # of what the robot's state and the targets are divided by


class ImageBatch(NamedTuple):
    """Instants to learn from.

    Attributes:
        images: ``(n, cameras, H, W, 3)`` uint8.
        robot: Numbers of the robot's state, ``(n, R)``.
        targets: Of each object x, y, z [m], cosine and sine of its yaw times its symmetry (world
            frame), and 1 if it is held, ``(n, objects, 6)``.
    """

    images: Tensor
    robot: Tensor
    targets: Tensor


class PoseNetwork(Network):
    """Encoders of images, one for each camera, and a perceptron behind them.

    Args:
        encoders: Built for the size of the crop.
        size: Of the crop [pixels].
        hidden: Units of the perceptron.
        robot: How many numbers there are of the robot's state.
        objects: Of the scenes.
    """

    def __init__(
        self,
        encoders: Sequence[nn.Module],
        size: int,
        hidden: int,
        robot: int,
        objects: Sequence[ObjectDescription],
    ) -> None:
        super().__init__()
        self._size = size
        self._symmetries = [item.yaw_symmetry for item in objects]
        self.encoders = nn.ModuleList(encoders)
        self.turns = nn.Buffer(torch.tensor([float(k > 0) for k in self._symmetries]))
        self.robot_mean, self.robot_scale = (nn.Buffer(torch.zeros(robot)) for _ in range(2))
        shape = (len(objects), 3)
        self.mean, self.scale = (nn.Buffer(torch.zeros(shape)) for _ in range(2))
        width = sum(int(item.width) + 2 for item in encoders) + robot
        self.layers = nn.Sequential(
            nn.Linear(width, hidden), nn.ReLU(), nn.Linear(hidden, 6 * len(objects))
        )

    def measure(self, robot: Tensor, targets: Tensor) -> None:
        """Take mean and spread of the robot's states and of positions, to normalise by."""
        for values, mean, scale in (
            (robot, self.robot_mean, self.robot_scale),
            (targets[..., :3], self.mean, self.scale),
        ):
            mean.copy_(values.mean(dim=0))
            scale.copy_(values.std(dim=0, correction=0).clamp_min(LEAST_SPREAD))

    def forward(
        self, images: Tensor, robot: Tensor, generator: torch.Generator | None = None
    ) -> Tensor:
        """Return what is told of each object: as targets, positions normalised, ``(n, O, 6)``.

        Args:
            images: ``(n, cameras, H, W, 3)`` uint8.
            robot: ``(n, R)``.
            generator: Of the crops; None for the centre.
        """
        seen = []
        for camera, encoder in enumerate(self.encoders):
            crops = crop(images[:, camera], self._size, self._size, generator)
            seen += [encoder(crops.parts), crops.places]
        seen.append((robot - self.robot_mean) / self.robot_scale)
        return self.layers(torch.cat(seen, dim=1)).unflatten(1, (-1, 6))

    def loss(self, batch: ImageBatch, generator: torch.Generator) -> Tensor:
        """Return the mean loss: of positions, yaws that there are, and of whether it is held."""
        with precision(batch.robot.device):
            found = self(batch.images, batch.robot, generator).float()
        places = (batch.targets[..., :3] - self.mean) / self.scale
        place = functional.smooth_l1_loss(found[..., :3], places, beta=LINEAR_FROM)
        yaw = (found[..., 3:5] - batch.targets[..., 3:5]).square().mean(dim=-1) * self.turns
        held = functional.binary_cross_entropy_with_logits(found[..., 5], batch.targets[..., 5])
        return place + YAW_WEIGHT * yaw.mean() + HELD_WEIGHT * held

    def targets(self, seen: Observations) -> np.ndarray:
        """Return the targets of instants whose object poses are known, ``(N, O, 6)``."""
        result = np.zeros((len(seen), len(self._symmetries), 6), dtype=np.float32)
        result[..., :3], result[..., 5] = seen.object_positions, seen.held
        for index, symmetry in enumerate(self._symmetries):
            angle = symmetry * yaw_of(seen.object_quaternions[:, index])
            result[:, index, 3], result[:, index, 4] = np.cos(angle), np.sin(angle)
        return result

    def environment_state(self, found: Tensor) -> np.ndarray:
        """Return upright objects where they were told to be, ``(N, O * 8)`` float32."""
        result = np.zeros((len(found), len(self._symmetries), OBJECT_WIDTH), dtype=np.float32)
        result[..., :3] = (found[..., :3] * self.scale + self.mean).numpy()
        for index, symmetry in enumerate(self._symmetries):
            cosine, sine = found[:, index, 3].numpy(), found[:, index, 4].numpy()
            half = np.arctan2(sine, cosine) / (2 * max(symmetry, 1)) * (symmetry > 0)
            result[:, index, 3], result[:, index, 6] = np.cos(half), np.sin(half)
        result[..., 7] = (found[..., 5] > 0).numpy()
        return result.reshape(len(found), -1)

"""Object poses from images and robot state."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from prime_core.contracts.description import ObjectDescription
from prime_core.contracts.observations import OBJECT_WIDTH, Observations
from prime_core.rotations import quaternion_product
from prime_policies.encoders.crops import crop
from prime_policies.networks.network import Network
from prime_policies.training.devices import precision

TURN_WEIGHT, HELD_WEIGHT = 0.3, 0.1
"""In the loss, of a position 1: places are what most parameters follow from."""
LINEAR_FROM = 0.1
"""Of a position's miss, over the spread of positions: beyond it the loss grows with the miss, not
its square. With 1, as is usual, a miss of a centimetre hardly counts where things lie decimetres
apart."""
TOLD = 9  # numbers of an object
PLACE, UP, YAW, HELD = slice(0, 3), slice(3, 6), slice(6, 8), 8
"""Of what is told: position; direction of the object's z axis; cosine and sine of its yaw times its
symmetry; and whether it is held. The yaw is the twist about the z axis, the tilt undone the short
way, and as little worth as near the object is to upside down: see `FeatureEncoder`."""
LEAST_SPREAD = 1e-3  # of what the robot's state and the targets are divided by


class ImageBatch(NamedTuple):
    """Instants to learn from.

    Attributes:
        images: ``(n, cameras, H, W, 3)`` uint8.
        robot: Numbers of the robot's state, ``(n, R)``.
        targets: Of each object what is to be told, lengths in metres, ``(n, objects, TOLD)``.
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
            nn.Linear(width, hidden), nn.ReLU(), nn.Linear(hidden, TOLD * len(objects))
        )

    def measure(self, robot: Tensor, targets: Tensor) -> None:
        """Take mean and spread of the robot's states and of positions, to normalise by."""
        for values, mean, scale in (
            (robot, self.robot_mean, self.robot_scale),
            (targets[..., PLACE], self.mean, self.scale),
        ):
            mean.copy_(values.mean(dim=0))
            scale.copy_(values.std(dim=0, correction=0).clamp_min(LEAST_SPREAD))

    def forward(
        self, images: Tensor, robot: Tensor, generator: torch.Generator | None = None
    ) -> Tensor:
        """Return what is told of each object: as targets, positions normalised, ``(n, O, TOLD)``.

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
        return self.layers(torch.cat(seen, dim=1)).unflatten(1, (-1, TOLD))

    def loss(self, batch: ImageBatch, generator: torch.Generator) -> Tensor:
        """Return the mean loss: of positions, turns, and of whether it is held."""
        with precision(batch.robot.device):
            found = self(batch.images, batch.robot, generator).float()
        wanted = batch.targets
        places = (wanted[..., PLACE] - self.mean) / self.scale
        place = functional.smooth_l1_loss(found[..., PLACE], places, beta=LINEAR_FROM)
        up = (found[..., UP] - wanted[..., UP]).square().mean()
        yaw = (found[..., YAW] - wanted[..., YAW]).square().mean(dim=-1) * self.turns
        held = functional.binary_cross_entropy_with_logits(found[..., HELD], wanted[..., HELD])
        return place + TURN_WEIGHT * (up + yaw.mean()) + HELD_WEIGHT * held

    def targets(self, seen: Observations) -> np.ndarray:
        """Return the targets of instants whose object poses are known, ``(N, O, TOLD)``."""
        result = np.zeros((len(seen), len(self._symmetries), TOLD), dtype=np.float32)
        result[..., PLACE], result[..., HELD] = seen.object_positions, seen.held
        w, x, y, z = np.moveaxis(seen.object_quaternions.astype(np.float64), -1, 0)
        up = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
        result[..., UP] = np.stack(up, axis=-1)
        twist = (w * w + z * z) * np.exp(2j * np.array(self._symmetries) * np.arctan2(z, w))
        result[..., YAW] = np.stack((twist.real, twist.imag), axis=-1)
        return result

    def environment_state(self, found: Tensor) -> np.ndarray:
        """Return objects as they were told to be, ``(N, O * 8)`` float32."""
        told = found.double().numpy()
        result = np.zeros((*told.shape[:2], OBJECT_WIDTH), dtype=np.float32)
        result[..., :3] = told[..., PLACE] * self.scale.numpy() + self.mean.numpy()
        symmetries = np.array(self._symmetries)
        turn = np.arctan2(told[..., YAW][..., 1], told[..., YAW][..., 0])
        result[..., 3:7] = _quaternions(
            told[..., UP], turn / np.maximum(symmetries, 1) * (symmetries > 0)
        )
        result[..., 7] = told[..., HELD] > 0
        return result.reshape(len(found), -1)


def _quaternions(up: np.ndarray, yaw: np.ndarray) -> np.ndarray:
    """Return the turns about z by yaws ``(...)``, then tilted so that z points along ``(..., 3)``.

    The tilt is the shortest one.
    """
    x, y, z = np.moveaxis(up / np.linalg.norm(up, axis=-1, keepdims=True).clip(1e-6), -1, 0)
    half = np.sqrt(((1 + z) / 2).clip(1e-6))
    tilt = np.stack((half, -y / (2 * half), x / (2 * half), np.zeros_like(x)), axis=-1)
    turn = np.zeros_like(tilt)
    turn[..., 0], turn[..., 3] = np.cos(yaw / 2), np.sin(yaw / 2)
    product = quaternion_product(tilt, turn)
    return product / np.linalg.norm(product, axis=-1, keepdims=True)

"""Trains and runs the network that tells object poses from images."""

from pathlib import Path
from typing import Self

import numpy as np
import torch
from torch import Tensor

from prime_core.contracts.observations import Observations
from prime_core.contracts.perception import Perception
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.errors import DatasetError
from prime_core.learning.model_card import check_card, fingerprint, make_card, write_card
from prime_policies.perception.pose_network import ImageBatch, PoseNetwork
from prime_policies.perception.settings import PoseNetworkSettings
from prime_policies.training.loop import Trainer
from prime_policies.training.repeatable import first_weights, threads
from prime_policies.training.weights import load_weights

KIND = "pose-network"
NAME = "perception"
"""Of the training, and of the file of weights."""
VERSION = 2  # of the weights
ROBOT_WIDTH = 6  # numbers of the robot's state that it sees beside images
AT_ONCE = 256  # instants whose images are in memory


class PosePerception(Perception):
    """Sees through cameras, and tells the object poses that a `PoseNetwork` finds.

    Args:
        settings: The network.
        context: The scenes, and the cameras.
        seed: Of the first weights.

    Raises:
        DatasetError: If there are no cameras.
    """

    def __init__(self, settings: PoseNetworkSettings, context: ModelContext, seed: int) -> None:
        if context.cameras is None:
            raise DatasetError("a perception was given no cameras to see through")
        self.settings, self.cameras = settings, context.cameras
        with first_weights(seed, NAME):
            encoders = [
                settings.encoder.build(settings.crop, settings.crop) for _ in self.cameras.cameras
            ]
            objects = context.description.objects
            self.network = PoseNetwork(
                encoders, settings.crop, settings.hidden, ROBOT_WIDTH, objects
            )
        dump = {**settings.model_dump(mode="json"), "images": self.cameras.model_dump(mode="json")}
        self.card = make_card(KIND, VERSION, dump, context)

    @classmethod
    def fit(
        cls, settings: PoseNetworkSettings, seen: Observations, context: TrainingContext
    ) -> Self:
        """Train it on instants whose object poses and images are known.

        Raises:
            DatasetError: If they are not.
            PrimeError: If the training diverges; see `Trainer.train`.
        """
        result = cls(settings, context, context.seed)
        if seen.environment_state is None or not seen.images:
            raise DatasetError(
                "what a perception learns from has no "
                + ("images" if seen.environment_state is not None else "object poses")
            )
        examples = _Instants(seen, result)
        result.network.measure(examples.robot, examples.targets)
        identity = fingerprint(result.card, context.seed, [seen])
        trainer = Trainer(context, identity, settings.epochs)
        trainer.train(NAME, result.network, examples, settings, settings.epochs)
        write_card(context.folder, result.card)
        result.network.eval()
        return result

    @classmethod
    def load(cls, settings: PoseNetworkSettings, folder: Path, context: ModelContext) -> Self:
        """Load what `fit` left.

        Raises:
            WeightsError: If there is none, or another one.
        """
        result = cls(settings, context, seed=0)
        check_card(folder, result.card)
        load_weights(result.network, folder / f"{NAME}.safetensors")
        result.network.eval()
        return result

    @torch.inference_mode()
    def see(self, seen: Observations) -> Observations:
        """Return instants with the poses that are told; see `Perception`."""
        states = []
        with threads():
            for start in range(0, len(seen), AT_ONCE):
                part = seen[np.arange(start, min(start + AT_ONCE, len(seen)))]
                found = self.network(self.images(part), _robot(part))
                states.append(self.network.environment_state(found))
        return Observations(seen.state, np.concatenate(states))

    def images(self, seen: Observations) -> Tensor:
        """Read the images of instants, ``(n, cameras, H, W, 3)`` uint8."""
        images = [np.asarray(seen.images[name]) for name in self.cameras.cameras]
        return torch.from_numpy(np.stack(images, axis=1))


class _Instants:
    """Instants to draw batches from; their images are read when they are drawn."""

    def __init__(self, seen: Observations, perception: PosePerception) -> None:
        self._seen, self._perception = seen, perception
        self.robot = _robot(seen)
        self.targets = torch.from_numpy(perception.network.targets(seen))

    def draws(self, generator: np.random.Generator, count: int) -> Tensor:
        """Draw instants with replacement, ``(count,)``."""
        return torch.from_numpy(generator.integers(len(self._seen), size=count))

    def batch(self, chosen: Tensor) -> ImageBatch:
        """Return the instants of some numbers."""
        images = self._perception.images(self._seen[chosen.numpy()])
        return ImageBatch(images, self.robot[chosen], self.targets[chosen])


def _robot(seen: Observations) -> Tensor:
    """Return position [m], opening [m] and direction of the gripper, ``(N, ROBOT_WIDTH)``."""
    yaw = 2 * seen.gripper_yaw  # half a turn of the jaws looks the same
    columns = (seen.gripper_position, seen.gripper_opening, np.cos(yaw), np.sin(yaw))
    return torch.from_numpy(np.column_stack(columns).astype(np.float32))

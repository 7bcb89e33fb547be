"""The one training loop of all networks."""

import math
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from prime_policies.adam import Adam
from prime_policies.examples import Source
from prime_policies.networks import Classifier, Examples, ParameterNetwork
from prime_policies.threads import one_thread
from prime_policies.weights import WeightsError, read_tensors, write_tensors

GRADIENT_LIMIT = 10.0


@dataclass(frozen=True)
class Schedule:
    """How long and how fast a network is trained.

    Attributes:
        epochs: After each one the state of the training is kept.
        steps_per_epoch: Steps of Adam.
        learning_rate: At the start; it falls to zero by half a cosine.
        weight_decay: Of Adam.
    """

    epochs: int
    steps_per_epoch: int
    learning_rate: float
    weight_decay: float

    def rate(self, step: int) -> float:
        """Return the learning rate at a step, counted from 0."""
        done = step / (self.epochs * self.steps_per_epoch)
        return self.learning_rate * 0.5 * (1 + math.cos(math.pi * done))


@dataclass(frozen=True)
class Training:
    """One training, that can be interrupted.

    Attributes:
        state: File that its state is kept in while it runs.
        identity: What tells it apart from trainings with other settings or data.
        seed: Of its random draws.
        schedule: How long and how fast.
    """

    state: Path
    identity: str
    seed: int
    schedule: Schedule

    def run(
        self,
        network: Classifier | ParameterNetwork,
        sources: Sequence[tuple[Source, int]],
        keep: Callable[[int], None],
        report: Callable[[int], None],
    ) -> None:
        """Train a network, from the last finished epoch if it was interrupted.

        Args:
            network: What is trained.
            sources: What examples come from, and how many of a batch from each.
            keep: Called with the number of finished epochs before an epoch's state is kept;
                may be called for the same epoch again after an interruption.
            report: Called with the same number after an epoch's state was kept.
        """
        optimiser = Adam(network.parameters(), self.schedule.weight_decay)
        with one_thread():
            for epoch in range(self._restore(network, optimiser), self.schedule.epochs):
                self._run_epoch(epoch, network, sources, optimiser)
                keep(epoch + 1)
                self._keep(epoch + 1, network, optimiser)
                report(epoch + 1)

    def finish(self) -> None:
        """Forget the state, once the result is kept."""
        self.state.unlink(missing_ok=True)

    def _run_epoch(
        self,
        epoch: int,
        network: Classifier | ParameterNetwork,
        sources: Sequence[tuple[Source, int]],
        optimiser: Adam,
    ) -> None:
        # An epoch's draws depend on nothing before it: a resumed training draws the same.
        generator = seeded(self.seed, self.state.name, epoch)
        noise = torch.Generator().manual_seed(int(generator.integers(2**62)))
        steps = self.schedule.steps_per_epoch
        draws = [
            source.draws(generator, steps * size).reshape(steps, size) for source, size in sources
        ]
        for step in range(steps):
            batches = [
                source.batch(rows[step]) for (source, _), rows in zip(sources, draws, strict=True)
            ]
            loss = network.loss(_join(batches), noise)
            gradients = torch.autograd.grad(loss, list(network.parameters()))
            optimiser.step(_limited(gradients), self.schedule.rate(epoch * steps + step))

    def _keep(self, epoch: int, network: Classifier | ParameterNetwork, optimiser: Adam) -> None:
        tensors = {f"network.{name}": value for name, value in network.state_dict().items()}
        tensors |= {f"adam.{name}": value for name, value in optimiser.state().items()}
        write_tensors(self.state, tensors, {"epoch": str(epoch), "identity": self.identity})

    def _restore(self, network: Classifier | ParameterNetwork, optimiser: Adam) -> int:
        """Go back to the last finished epoch, and return how many were finished."""
        if not self.state.exists():
            return 0
        tensors, notes = read_tensors(self.state)
        check_identity(self.state, notes, self.identity)
        network.load_state_dict(_part(tensors, "network."))
        optimiser.restore(_part(tensors, "adam."))
        return int(notes["epoch"])


def check_identity(path: Path, notes: dict[str, str], identity: str) -> None:
    """Make sure that a file was left by the training that goes on.

    Raises:
        WeightsError: If it was left by another one.
    """
    if notes.get("identity") != identity:
        raise WeightsError(
            f"{path} was left by a training with other settings, seed or data. Remove "
            f"{path.parent} to train anew, or train into another folder."
        )


def seeded(seed: int, name: str, number: int) -> np.random.Generator:
    """Return the generator of a named and numbered part of a training."""
    return np.random.default_rng([seed, zlib.crc32(name.encode()), number])


def _join(batches: Sequence[Examples]) -> Examples:
    if len(batches) == 1:
        return batches[0]
    return Examples(*(torch.cat(parts) for parts in zip(*batches, strict=True)))


def _part(tensors: Mapping[str, Tensor], prefix: str) -> dict[str, Tensor]:
    return {
        name.removeprefix(prefix): value
        for name, value in tensors.items()
        if name.startswith(prefix)
    }


def _limited(gradients: Sequence[Tensor]) -> list[Tensor]:
    """Scale gradients down where they are too large: one strange batch must not undo a training."""
    norm = torch.stack([gradient.norm() for gradient in gradients]).norm()
    scale = (GRADIENT_LIMIT / norm).clamp_max(1.0)
    return [gradient * scale for gradient in gradients]

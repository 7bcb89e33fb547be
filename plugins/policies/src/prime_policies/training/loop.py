"""The one training loop: resumable, seeded, and it stops where numbers are not finite."""

import math
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np
import torch
from torch import Tensor, nn
from torch.optim.lr_scheduler import LambdaLR

from prime_core.contracts.training import TrainingContext
from prime_core.errors import PrimeError
from prime_policies.networks.batch import Batch
from prime_policies.training.examples import Examples
from prime_policies.training.threads import threads
from prime_policies.training.weights import WeightsError, load_weights, read_tensors, write_tensors

GRADIENT_LIMIT = 10.0  # one strange batch must not undo a training
FAST = 10.0  # times the learning rate of offsets and precisions, of which there are few


class Trainable(Protocol):
    """A network that the loop trains."""

    def loss(self, batch: Batch, generator: torch.Generator) -> Tensor:
        """Return the loss of a batch; the generator is of noise."""


@dataclass(frozen=True)
class Schedule:
    """How long and how fast a network is trained.

    Attributes:
        epochs: After each one the state of the training is kept.
        steps_per_epoch: Steps of AdamW.
        learning_rate: At the start; it falls to zero by half a cosine.
        weight_decay: Decoupled.
        batch_size: Examples of a step.
    """

    epochs: int
    steps_per_epoch: int
    learning_rate: float
    weight_decay: float
    batch_size: int

    def share(self, step: int) -> float:
        """Return the share of the learning rate at a step, counted from 0."""
        return 0.5 * (1 + math.cos(math.pi * step / (self.epochs * self.steps_per_epoch)))


def keep_nothing(epoch: int) -> None:
    """Keep nothing of an epoch but the state of the training."""


@dataclass
class Trainer:
    """Runs trainings, one after the other, that leave their results in one folder.

    Attributes:
        context: Where and how.
        identity: What tells these trainings apart from those with other settings or data.
        total: Number of epochs of all trainings.
        done: Number of those of the trainings so far.
    """

    context: TrainingContext
    identity: str
    total: int
    done: int = field(default=0, init=False)

    def train(
        self,
        name: str,
        network: nn.Module,
        examples: Examples,
        schedule: Schedule,
        keep: Callable[[int], None] = keep_nothing,
    ) -> None:
        """Train a network, unless its result is there: then load that.

        Args:
            name: Of the training, unique in the folder.
            network: A `Trainable`.
            examples: What batches are drawn from.
            schedule: How long and how fast.
            keep: Called with the number of finished epochs before an epoch's state is kept; may be
                called for the same epoch again after an interruption.

        Raises:
            PrimeError: If a loss or a weight is not finite. Nothing is kept as done.
            WeightsError: If the folder holds another training.
        """
        before, self.done = self.done, self.done + schedule.epochs
        path = self.context.folder / f"{name}.safetensors"
        if path.exists():
            check_identity(path, read_tensors(path)[1], self.identity)
            load_weights(network, path)
            return
        with threads(self.context.threads):
            run = _Run(self, name, network, schedule)
            for epoch in range(run.restore(), schedule.epochs):
                run.epoch(epoch, examples)
                keep(epoch + 1)
                run.keep(epoch + 1)
                self.context.progress(before + epoch + 1, self.total)
        write_tensors(path, network.state_dict(), {"identity": self.identity})
        run.state.unlink(missing_ok=True)


class _Run:
    """One training: a network, its optimiser and its schedule."""

    def __init__(self, trainer: Trainer, name: str, network: nn.Module, schedule: Schedule) -> None:
        self.state = trainer.context.folder / f"{name}.training.safetensors"
        self._identity, self._seed = trainer.identity, trainer.context.seed
        self._name, self._network, self._schedule = name, network, schedule
        self._optimiser = _optimiser(network, schedule)
        self._rates = LambdaLR(self._optimiser, schedule.share)

    def epoch(self, number: int, examples: Examples) -> None:
        """Train for an epoch, whose draws depend on nothing before it."""
        generator = seeded(self._seed, self._name, number)
        noise = torch.Generator().manual_seed(int(generator.integers(2**62)))
        steps, size = self._schedule.steps_per_epoch, self._schedule.batch_size
        draws = examples.draws(generator, steps * size).reshape(steps, size)
        for chosen in draws:
            loss: Tensor = self._network.loss(examples.batch(chosen), noise)  # type: ignore[operator]
            self._optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(self._network.parameters(), GRADIENT_LIMIT)
            self._optimiser.step()
            self._rates.step()
            if not torch.isfinite(loss):
                self._diverged(number, f"the loss is {float(loss.detach())}")
        for name, value in self._network.named_parameters():
            if not torch.isfinite(value).all():
                self._diverged(number, f"weight {name!r} is not finite")

    def _diverged(self, epoch: int, what: str) -> None:
        self.state.unlink(missing_ok=True)
        raise PrimeError(
            f"training {self._name!r} diverged in epoch {epoch + 1}: {what}. Nothing was kept: "
            f"lower learning_rate (it is {self._schedule.learning_rate:g})"
        )

    def keep(self, epoch: int) -> None:
        """Keep the state after a finished epoch."""
        tensors = {f"network.{name}": value for name, value in self._network.state_dict().items()}
        notes = {"epoch": str(epoch), "identity": self._identity}
        for number, values in self._optimiser.state_dict()["state"].items():
            tensors |= {f"optimiser.{number}.{name}": value for name, value in values.items()}
        write_tensors(self.state, tensors, notes)

    def restore(self) -> int:
        """Go back to the last finished epoch, and return how many were finished."""
        if not self.state.exists():
            return 0
        tensors, notes = read_tensors(self.state)
        check_identity(self.state, notes, self._identity)
        self._network.load_state_dict(_part(tensors, "network."))
        done = int(notes["epoch"])
        states: dict[int, dict[str, Tensor]] = {}
        for key, value in _part(tensors, "optimiser.").items():
            number, _, name = key.partition(".")
            states.setdefault(int(number), {})[name] = value
        self._optimiser.load_state_dict({**self._optimiser.state_dict(), "state": states})
        steps = done * self._schedule.steps_per_epoch
        self._rates.load_state_dict({**self._rates.state_dict(), "last_epoch": steps})
        for group, rate in zip(self._optimiser.param_groups, self._rates.base_lrs, strict=True):
            group["lr"] = rate * self._schedule.share(steps)
        return done


def _optimiser(network: nn.Module, schedule: Schedule) -> torch.optim.AdamW:
    few = [value for name, value in network.named_parameters() if _is_of_mixture(name)]
    many = [value for name, value in network.named_parameters() if not _is_of_mixture(name)]
    groups = [
        {"params": many, "lr": schedule.learning_rate, "weight_decay": schedule.weight_decay},
        {"params": few, "lr": FAST * schedule.learning_rate, "weight_decay": 0.0},
    ]
    return torch.optim.AdamW([group for group in groups if group["params"]], fused=True)


def _is_of_mixture(name: str) -> bool:
    return name.endswith(("offsets", "log_precisions"))


def check_identity(path: Path, notes: Mapping[str, str], identity: str) -> None:
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


def start_network[AnyNetwork: nn.Module](
    build: Callable[[], AnyNetwork], seed: int, name: str
) -> AnyNetwork:
    """Build a network whose first weights depend on a seed and a name only."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(int(seeded(seed, name, 0).integers(2**62)))
        return build().eval()


def _part(tensors: Mapping[str, Tensor], prefix: str) -> dict[str, Tensor]:
    return {
        name.removeprefix(prefix): value
        for name, value in tensors.items()
        if name.startswith(prefix)
    }

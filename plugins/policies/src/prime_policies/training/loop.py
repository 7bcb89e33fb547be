"""The one training loop: resumable, seeded, and it stops where numbers are not finite."""

from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch
from torch import Tensor, nn

from prime_core.contracts.training import TrainingContext
from prime_core.errors import PrimeError, WeightsError
from prime_policies.networks.network import Network
from prime_policies.training.devices import torch_device
from prime_policies.training.repeatable import seeded, threads
from prime_policies.training.settings import TrainingSettings
from prime_policies.training.weights import read_tensors, write_tensors

FAST = 10.0  # times the learning rate of offsets and precisions, of which there are few


class Source(Protocol):
    """Examples to draw batches from, such as `Examples`."""

    def draws(self, generator: np.random.Generator, count: int) -> Tensor:
        """Draw numbers of examples with replacement, ``(count,)``."""

    def batch(self, chosen: Tensor) -> Any:
        """Return the examples of some numbers: a named tuple of tensors that `loss` takes."""


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
        network: Network,
        examples: Source,
        settings: TrainingSettings,
        epochs: int,
        keep: Callable[[int], None] | None = None,
    ) -> None:
        """Train a network, unless its result is there: then load that.

        Args:
            name: Of the training, unique in the folder.
            network: Trained in place.
            examples: What batches are drawn from.
            settings: How a step goes, and how many of them an epoch has.
            epochs: How many; after each one the state of the training is kept.
            keep: Called with the number of finished epochs before an epoch's state is kept; may be
                called for the same epoch again after an interruption.

        Raises:
            PrimeError: If a loss or a weight is not finite, or if there is no GPU where one is
                asked for. Nothing is kept as done.
            WeightsError: If the folder holds another training.
        """
        before, self.done = self.done, self.done + epochs
        path = self.context.folder / f"{name}.safetensors"
        if path.exists():
            network.load_state_dict(self.read(path)[0])
            return
        with threads(self.context.threads):
            device = torch_device(self.context.device)
            run = _Run(self, name, network.to(device), settings, epochs)
            for epoch in range(run.restore(), epochs):
                run.epoch(epoch, examples)
                if keep is not None:
                    keep(epoch + 1)
                run.keep(epoch + 1)
                self.context.progress(before + epoch + 1, self.total)
        self.write(path, network.cpu().state_dict())
        run.state.unlink(missing_ok=True)

    def write(self, path: Path, tensors: Mapping[str, Tensor], **notes: str) -> None:
        """Write tensors, and whose they are."""
        write_tensors(path, tensors, {**notes, "identity": self.identity})

    def read(self, path: Path) -> tuple[dict[str, Tensor], dict[str, str]]:
        """Read tensors and notes that these trainings wrote.

        Raises:
            WeightsError: If another training did.
        """
        tensors, notes = read_tensors(path)
        if notes.get("identity") != self.identity:
            raise WeightsError(
                f"{path} was left by a training with other settings, seed or data. Remove "
                f"{path.parent} to train anew, or train into another folder."
            )
        return tensors, notes


class _Run:
    """One training: a network, its optimiser and how long it takes."""

    def __init__(
        self, trainer: Trainer, name: str, network: Network, settings: TrainingSettings, epochs: int
    ) -> None:
        self.state = trainer.context.folder / f"{name}.training.safetensors"
        self._trainer, self._name, self._network = trainer, name, network
        self._settings, self._epochs = settings, epochs
        rate, decay = settings.learning_rate, settings.weight_decay
        groups: dict[tuple[float, float], list[Tensor]] = {
            (rate, decay): [],
            (FAST * rate, 0.0): [],
        }
        for key, value in network.named_parameters():
            few = key.endswith(("offsets", "log_precisions"))
            own = (FAST * rate, 0.0) if few else (network.rate_share(key) * rate, decay)
            groups.setdefault(own, []).append(value)
        self._optimiser = torch.optim.AdamW(
            [
                {"params": values, "first_lr": first, "weight_decay": decay}
                for (first, decay), values in groups.items()
            ],
            fused=True,
        )

    def epoch(self, number: int, examples: Source) -> None:
        """Train for an epoch, whose draws depend on nothing before it."""
        generator = seeded(self._trainer.context.seed, self._name, number)
        noise = torch.Generator().manual_seed(int(generator.integers(2**62)))
        steps, size = self._settings.steps_per_epoch, self._settings.batch_size
        draws = examples.draws(generator, steps * size).reshape(steps, size)
        device = next(self._network.parameters()).device
        for step, chosen in enumerate(draws, start=number * steps):
            for group in self._optimiser.param_groups:
                share = self._settings.share_of_rate(step, self._epochs * steps)
                group["lr"] = group["first_lr"] * share
            batch = examples.batch(chosen)
            loss = self._network.loss(type(batch)(*(part.to(device) for part in batch)), noise)
            self._optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(self._network.parameters(), self._settings.gradient_limit)
            self._optimiser.step()
            if not torch.isfinite(loss):
                self._diverged(number, f"the loss is {float(loss.detach())}")
        for name, value in self._network.named_parameters():
            if not torch.isfinite(value).all():
                self._diverged(number, f"weight {name!r} is not finite")

    def _diverged(self, epoch: int, what: str) -> None:
        self.state.unlink(missing_ok=True)
        raise PrimeError(
            f"training {self._name!r} diverged in epoch {epoch + 1}: {what}. Nothing was kept: "
            f"lower learning_rate (it is {self._settings.learning_rate:g})"
        )

    def keep(self, epoch: int) -> None:
        """Keep the state after a finished epoch."""
        tensors = {f"network.{name}": value for name, value in self._network.state_dict().items()}
        for number, values in self._optimiser.state_dict()["state"].items():
            tensors |= {f"optimiser.{number}.{name}": value for name, value in values.items()}
        self._trainer.write(self.state, tensors, epoch=str(epoch))

    def restore(self) -> int:
        """Go back to the last finished epoch, and return how many were finished."""
        if not self.state.exists():
            return 0
        tensors, notes = self._trainer.read(self.state)
        moments: dict[int, dict[str, Tensor]] = defaultdict(dict)
        for key in [key for key in tensors if key.startswith("optimiser.")]:
            _, number, name = key.split(".")
            moments[int(number)][name] = tensors.pop(key)
        weights = {key.removeprefix("network."): value for key, value in tensors.items()}
        self._network.load_state_dict(weights)
        self._optimiser.load_state_dict({**self._optimiser.state_dict(), "state": moments})
        return int(notes["epoch"])

"""A folder that several trainings, one after the other, leave their results in."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from prime_core.contracts.training import Progress
from prime_policies.examples import Source
from prime_policies.networks import Classifier, ParameterNetwork
from prime_policies.training import Schedule, Training, check_identity
from prime_policies.weights import load_weights, read_tensors, write_tensors


def keep_nothing(epoch: int) -> None:
    """Keep nothing of an epoch but the state of the training."""


@dataclass
class TrainingFolder:
    """Runs trainings that can be interrupted and counts their epochs together.

    Attributes:
        folder: Where results are kept, as ``NAME.safetensors``.
        identity: What tells these trainings apart from those with other settings or data.
        seed: Of all random draws.
        progress: Told of finished epochs.
        total: Number of epochs of all trainings.
        done: Number of those of the trainings so far.
    """

    folder: Path
    identity: str
    seed: int
    progress: Progress
    total: int
    done: int = 0

    def train(
        self,
        name: str,
        network: Classifier | ParameterNetwork,
        sources: Sequence[tuple[Source, int]],
        schedule: Schedule,
        keep: Callable[[int], None] = keep_nothing,
    ) -> None:
        """Train a network, unless its result is there: then load that.

        Args:
            name: Of the training, unique in the folder.
            network: What is trained.
            sources: What examples come from, and how many of a batch from each.
            schedule: How long and how fast.
            keep: See `Training.run`.
        """
        before, self.done = self.done, self.done + schedule.epochs
        path = self.folder / f"{name}.safetensors"
        if path.exists():
            check_identity(path, read_tensors(path)[1], self.identity)
            load_weights(network, path)
            return
        state = self.folder / f"{name}.training.safetensors"
        training = Training(state, self.identity, self.seed, schedule)
        training.run(
            network, sources, keep, lambda epoch: self.progress(before + epoch, self.total)
        )
        write_tensors(path, network.state_dict(), {"identity": self.identity})
        training.finish()

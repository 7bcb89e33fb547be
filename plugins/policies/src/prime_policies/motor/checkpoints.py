"""The checkpoints of policies over motor actions: how they are trained, and what they tell."""

from pathlib import Path

from prime_core.errors import WeightsError
from prime_core.learning.model_card import Card, write_card
from prime_policies.motor.settings import MotorTrainingSettings
from prime_policies.networks.network import Network
from prime_policies.training.loop import Source, Trainer
from prime_policies.training.weights import read_tensors

NAME = "policy"
"""Of the training, and of the files of weights."""
LOW = "scaling.low"
"""The weights that are as many as an action has numbers."""


def train_checkpoints(
    trainer: Trainer,
    network: Network,
    examples: Source,
    settings: MotorTrainingSettings,
    card: Card,
) -> list[Path]:
    """Train a policy's network on demonstrations, and return its checkpoints, the oldest first.

    Raises:
        PrimeError: If the training diverges; see `Trainer.train`.
    """
    folder = trainer.context.folder
    numbers = {epoch: number for number, epoch in enumerate(settings.kept_epochs, start=1)}
    folders = {epoch: folder / f"checkpoint_{n:02d}" for epoch, n in numbers.items()}

    def keep(epoch: int) -> None:
        if epoch in folders:
            trainer.write(folders[epoch] / f"{NAME}.safetensors", network.state_dict())
            write_card(folders[epoch], card)  # with it the checkpoint is complete

    trainer.train(NAME, network, examples, settings, settings.epochs, keep)
    return [*folders.values()]


def actions_of(path: Path) -> int:
    """Return how many numbers an action has that a network's weights tell.

    Raises:
        WeightsError: If the file is missing or damaged, or the weights are of another network.
    """
    tensors, _ = read_tensors(path)
    if LOW not in tensors:
        raise WeightsError(f"{path} holds the weights of another network: it has no {LOW!r}")
    return tensors[LOW].numel()

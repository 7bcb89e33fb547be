"""How networks over motor actions are trained: on windows of rollouts, then of demonstrations."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.errors import DatasetError
from prime_core.learning.model_card import Card, check_card, fingerprint, make_card, write_card
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.scaling import Scaling
from prime_policies.motor.settings import MotorTrainingSettings
from prime_policies.motor.windows import Windows
from prime_policies.networks.network import Network
from prime_policies.training.loop import Trainer
from prime_policies.training.repeatable import first_weights
from prime_policies.training.weights import load_weights, read_tensors

NAME = "policy"
"""Of the training, and of the files of weights."""
LOW = "scaling.low"
"""The weights that are as many as an action has numbers."""


class MotorNetwork(Network):
    """What is trained on windows.

    Attributes:
        scaling: Of features and actions; what is learnt from tells them.
    """

    scaling: Scaling


@dataclass(frozen=True)
class Design[AnyNetwork: MotorNetwork]:
    """A network over motor actions, and what it learns from.

    Attributes:
        kind: Name that it is registered under.
        version: Of the weights; rises when older ones would mean something else.
        settings: Of the network and its training.
        build: Makes the network, of so many features of an instant and numbers of an action.
        steps: Of a window.
        before: Of these, steps before the one that a window is drawn by.
    """

    kind: str
    version: int
    settings: MotorTrainingSettings
    build: Callable[[int, int], AnyNetwork]
    steps: int
    before: int = 0

    def card(self, context: ModelContext) -> Card:
        """Return what weights are for."""
        return make_card(self.kind, self.version, self.settings.model_dump(mode="json"), context)

    def windows(
        self, episodes: Sequence[Demonstration], encoder: FeatureEncoder, source: str
    ) -> Windows:
        """Return the windows of episodes; see `Windows`."""
        return Windows(episodes, encoder, self.steps, source, self.before)


def fit_network(
    design: Design[MotorNetwork],
    rollouts: Sequence[Demonstration] | None,
    demonstrations: Sequence[Demonstration],
    context: TrainingContext,
) -> list[Path]:
    """Train a network, and return its checkpoints.

    Features and actions are normalised by all that is learnt from.

    Raises:
        DatasetError: If there is nothing to learn from, or actions are not equally wide.
        PrimeError: If the training diverges; see `Trainer.train`.
    """
    settings, encoder = design.settings, FeatureEncoder(context.description)
    shown = design.windows(demonstrations, encoder, "the demonstrations")
    parts = [shown]
    if rollouts is not None:
        parts.insert(0, design.windows(rollouts, encoder, "the rollouts"))
    widths = [part.actions.shape[1] for part in parts]
    if len(set(widths)) > 1:
        raise DatasetError(
            f"actions of the rollouts have {widths[0]} numbers, those of the demonstrations "
            f"{widths[1]}: pretraining needs as many"
        )
    with first_weights(context.seed, NAME):
        network = design.build(encoder.width, widths[0])
    network.scaling.measure([part.features for part in parts], [part.actions for part in parts])
    card = design.card(context)
    identity = fingerprint({**card, "data": [part.digest for part in parts]}, context.seed, [])
    before = settings.pretraining_epochs if rollouts is not None else 0
    trainer = Trainer(context, identity, before + settings.epochs)
    if before:
        trainer.train(f"{NAME}.pretrained", network, parts[0], settings, before)
    numbers = {epoch: number for number, epoch in enumerate(settings.kept_epochs, start=1)}
    folders = {epoch: context.folder / f"checkpoint_{n:02d}" for epoch, n in numbers.items()}

    def keep(epoch: int) -> None:
        if epoch in folders:
            trainer.write(folders[epoch] / f"{NAME}.safetensors", network.state_dict())
            write_card(folders[epoch], card)  # with it the checkpoint is complete

    trainer.train(NAME, network, shown, settings, settings.epochs, keep)
    return [*folders.values()]


def load_network[AnyNetwork: MotorNetwork](
    design: Design[AnyNetwork], folder: Path, context: ModelContext
) -> tuple[AnyNetwork, FeatureEncoder]:
    """Load the network of a checkpoint, for actions as wide as it learnt them, and its encoder.

    Raises:
        WeightsError: If there is none, or another one.
    """
    check_card(folder, design.card(context))
    path = folder / f"{NAME}.safetensors"
    tensors, _ = read_tensors(path)
    encoder = FeatureEncoder(context.description)
    # Weights of another network may have none: then they fit none.
    actions = tensors[LOW].numel() if LOW in tensors else 0
    network = design.build(encoder.width, actions)
    load_weights(network, path)
    return network, encoder

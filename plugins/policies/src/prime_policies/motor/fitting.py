"""How ``bc-rnn`` is trained: on windows of rollouts, if asked, then of demonstrations."""

from collections.abc import Sequence
from pathlib import Path

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.errors import DatasetError
from prime_core.learning.model_card import Card, check_card, fingerprint, make_card, write_card
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.bc_rnn import BcRnn
from prime_policies.motor.settings import BcRnnSettings
from prime_policies.motor.windows import Windows
from prime_policies.training.loop import Trainer
from prime_policies.training.repeatable import first_weights
from prime_policies.training.weights import load_weights, read_tensors

KIND = "bc-rnn"
NAME = "policy"
"""Of the training, and of the files of weights."""
VERSION = 1  # of the weights
LOW = "scaling.low"
"""The weights that are as many as an action has numbers."""


def fit_bc_rnn(
    settings: BcRnnSettings,
    rollouts: Sequence[Demonstration] | None,
    demonstrations: Sequence[Demonstration],
    context: TrainingContext,
) -> list[Path]:
    """Train the network, and return its checkpoints.

    Features and actions are normalised by all that is learnt from.

    Raises:
        DatasetError: If there is nothing to learn from, or actions are not equally wide.
        PrimeError: If the training diverges; see `Trainer.train`.
    """
    encoder = FeatureEncoder(context.description)
    shown = Windows(demonstrations, encoder, settings.horizon, "the demonstrations")
    parts = [shown]
    if rollouts is not None:
        parts.insert(0, Windows(rollouts, encoder, settings.horizon, "the rollouts"))
    widths = [part.actions.shape[1] for part in parts]
    if len(set(widths)) > 1:
        raise DatasetError(
            f"actions of the rollouts have {widths[0]} numbers, those of the demonstrations "
            f"{widths[1]}: pretraining needs as many"
        )
    with first_weights(context.seed, NAME):
        network = BcRnn(encoder.width, widths[0], settings)
    network.scaling.measure([part.features for part in parts], [part.actions for part in parts])
    card = _card(settings, context)
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


def load_bc_rnn(
    settings: BcRnnSettings, folder: Path, context: ModelContext
) -> tuple[BcRnn, FeatureEncoder]:
    """Load the network of a checkpoint, for actions as wide as it learnt them, and its encoder.

    Raises:
        WeightsError: If there is none, or another one.
    """
    check_card(folder, _card(settings, context))
    path = folder / f"{NAME}.safetensors"
    tensors, _ = read_tensors(path)
    encoder = FeatureEncoder(context.description)
    # Weights of another network may have none: then they fit none.
    actions = tensors[LOW].numel() if LOW in tensors else 0
    network = BcRnn(encoder.width, actions, settings)
    load_weights(network, path)
    return network, encoder


def _card(settings: BcRnnSettings, context: ModelContext) -> Card:
    return make_card(KIND, VERSION, settings.model_dump(mode="json"), context)

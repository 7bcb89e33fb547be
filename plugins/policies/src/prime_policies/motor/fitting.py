"""How ``bc-rnn`` is trained: on windows of rollouts, if asked, then of demonstrations."""

from collections.abc import Sequence
from pathlib import Path

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.learning.model_card import Card, check_card, fingerprint, make_card
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.bc_rnn import BcRnn
from prime_policies.motor.checkpoints import NAME, actions_of, train_checkpoints
from prime_policies.motor.settings import BcRnnSettings
from prime_policies.motor.windows import Windows, common_width
from prime_policies.training.loop import Trainer
from prime_policies.training.repeatable import first_weights
from prime_policies.training.weights import load_weights

KIND = "bc-rnn"
VERSION = 1  # of the weights


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
    prior = None
    if rollouts is not None:
        prior = Windows(rollouts, encoder, settings.horizon, "the rollouts")
    parts = [shown] if prior is None else [prior, shown]
    with first_weights(context.seed, NAME):
        network = BcRnn(encoder.width, common_width(prior, shown), settings)
    network.scaling.measure([part.features for part in parts], [part.actions for part in parts])
    card = _card(settings, context)
    identity = fingerprint({**card, "data": [part.digest for part in parts]}, context.seed, [])
    before = settings.pretraining_epochs if prior is not None else 0
    trainer = Trainer(context, identity, before + settings.epochs)
    if prior is not None:
        trainer.train(f"{NAME}.pretrained", network, prior, settings, before)
    return train_checkpoints(trainer, network, shown, settings, card)


def load_bc_rnn(
    settings: BcRnnSettings, folder: Path, context: ModelContext
) -> tuple[BcRnn, FeatureEncoder]:
    """Load the network of a checkpoint, for actions as wide as it learnt them, and its encoder.

    Raises:
        WeightsError: If there is none, or another one.
    """
    check_card(folder, _card(settings, context))
    path = folder / f"{NAME}.safetensors"
    encoder = FeatureEncoder(context.description)
    network = BcRnn(encoder.width, actions_of(path), settings)
    load_weights(network, path)
    return network, encoder


def _card(settings: BcRnnSettings, context: ModelContext) -> Card:
    return make_card(KIND, VERSION, settings.model_dump(mode="json"), context)

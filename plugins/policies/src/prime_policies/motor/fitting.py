"""How networks over motor actions are trained: on windows of rollouts, then of demonstrations."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.learning.model_card import Card, check_card, fingerprint, make_card
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.checkpoints import NAME, actions_of, train_checkpoints
from prime_policies.motor.scaling import Scaling
from prime_policies.motor.settings import MotorTrainingSettings
from prime_policies.motor.windows import Windows, common_width
from prime_policies.networks.network import Network
from prime_policies.training.loop import Trainer
from prime_policies.training.repeatable import first_weights
from prime_policies.training.weights import load_weights


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
    prior = None
    if rollouts is not None:
        prior = design.windows(rollouts, encoder, "the rollouts")
    parts = [shown] if prior is None else [prior, shown]
    with first_weights(context.seed, NAME):
        network = design.build(encoder.width, common_width(prior, shown))
    network.scaling.measure([part.features for part in parts], [part.actions for part in parts])
    card = design.card(context)
    identity = fingerprint({**card, "data": [part.digest for part in parts]}, context.seed, [])
    before = settings.pretraining_epochs if prior is not None else 0
    trainer = Trainer(context, identity, before + settings.epochs)
    if prior is not None:
        trainer.train(f"{NAME}.pretrained", network, prior, settings, before)
    return train_checkpoints(trainer, network, shown, settings, card)


def load_network[AnyNetwork: MotorNetwork](
    design: Design[AnyNetwork], folder: Path, context: ModelContext
) -> tuple[AnyNetwork, FeatureEncoder]:
    """Load the network of a checkpoint, for actions as wide as it learnt them, and its encoder.

    Raises:
        WeightsError: If there is none, or another one.
    """
    check_card(folder, design.card(context))
    path = folder / f"{NAME}.safetensors"
    encoder = FeatureEncoder(context.description)
    network = design.build(encoder.width, actions_of(path))
    load_weights(network, path)
    return network, encoder

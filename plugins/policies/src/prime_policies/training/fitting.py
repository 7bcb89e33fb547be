"""How the two networks are trained: on one kind of data after another."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prime_core.contracts.training import CallData, TrainingContext
from prime_core.learning.model_card import fingerprint, write_card
from prime_policies.networks.network import Network
from prime_policies.training.call_networks import CLASSIFIER, PARAMETERS, CallNetworks
from prime_policies.training.examples import Examples, joined
from prime_policies.training.loop import Trainer
from prime_policies.training.repeatable import seeded
from prime_policies.training.settings import NetworkSettings


@dataclass(frozen=True)
class Phase:
    """A part of a training: on what data, and for how long.

    Attributes:
        data: What is learnt from.
        epochs: Of the classifier, and of the mixtures.
        steps: Of an epoch.
        suffix: Of the names of its trainings.
        checkpoints: Folder for each epoch's networks; empty for none.
    """

    data: CallData
    epochs: tuple[int, int]
    steps: int
    suffix: str = ""
    checkpoints: Sequence[Path] = ()


def fit_networks(
    settings: NetworkSettings, phases: Sequence[Phase], context: TrainingContext
) -> CallNetworks:
    """Train the classifier in all phases, then the mixtures.

    Each phase has its share of the mixtures' components: they start where its examples gather, and
    take part from then on.

    Raises:
        DatasetError: If a phase has nothing to learn from.
        PrimeError: If a training diverges; see `Trainer.train`.
    """
    networks = CallNetworks(settings, context, context.seed)
    identity = fingerprint(networks.card, context.seed, [phase.data for phase in phases])
    trainer = Trainer(context, identity, sum(sum(phase.epochs) for phase in phases))
    types, parameters = zip(*(networks.examples(phase.data) for phase in phases), strict=True)

    def train(name: str, network: Network, phase: Phase, examples: Examples, epochs: int) -> None:
        def keep(epoch: int) -> None:
            folder = phase.checkpoints[epoch - 1]
            trainer.write(folder / f"{name}.safetensors", network.state_dict())
            if name == PARAMETERS:  # with it a checkpoint is complete
                write_card(folder, networks.card)

        own = settings.model_copy(update={"steps_per_epoch": phase.steps})
        keeping = keep if phase.checkpoints else None
        trainer.train(name + phase.suffix, network, examples, own, epochs, keeping)

    classifier = networks.classifier
    classifier.trunk.measure(joined(types).features)
    for phase, examples in zip(phases, types, strict=True):
        train(CLASSIFIER, classifier, phase, examples, phase.epochs[0])

    mixtures = networks.mixtures
    batch = joined(parameters)
    mixtures.trunk.measure(batch.features)
    if settings.pair:
        mixtures.fit_affine(batch)
    generator = seeded(context.seed, "start", 0)
    shares = np.array_split(np.arange(settings.components), len(phases))
    for examples, share in zip(parameters, shares, strict=True):
        mixtures.start(examples.everything(), share.tolist(), generator)
    for number, (phase, examples) in enumerate(zip(phases, parameters, strict=True), start=1):
        mixtures.activate(np.concatenate(shares[:number]).tolist())
        train(PARAMETERS, mixtures, phase, examples, phase.epochs[1])
    return networks

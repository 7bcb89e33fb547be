"""How the policy ``prime`` is trained and loaded."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import torch
from torch import nn

from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.networks.classifier import Classifier
from prime_policies.networks.parameter_network import ParameterNetwork
from prime_policies.primitive_policy.policy import PrimePolicy
from prime_policies.primitive_policy.settings import PrimePolicySettings
from prime_policies.training import building
from prime_policies.training.building import CLASSIFIER, PARAMETERS
from prime_policies.training.call_examples import CallEncoder
from prime_policies.training.examples import Examples, fingerprint
from prime_policies.training.loop import Trainer, seeded
from prime_policies.training.weights import (
    Card,
    check_card,
    load_weights,
    make_card,
    write_card,
    write_tensors,
)

KIND = "prime"


def fit_policy(
    config: PrimePolicySettings,
    rollouts: CallData | None,
    demonstrations: CallData,
    context: TrainingContext,
) -> list[Path]:
    """Train the classifier, then the parameters; see `PrimitivePolicyConfig.fit`."""
    context.folder.mkdir(parents=True, exist_ok=True)
    data = [*([] if rollouts is None else [rollouts]), demonstrations]
    card = _card(config, context)
    encoder = CallEncoder(context.description, context.space, pair=False)
    classifier, parameters = _build(config, encoder, context, context.seed)
    epochs = config.finetuning_epochs + (len(data) - 1) * config.pretraining_epochs
    trainer = Trainer(context, fingerprint(card, context.seed, data), 2 * epochs)
    fitting = _Fitting(config, trainer)

    examples = [encoder.types(item) for item in data]
    _measure(classifier, examples)
    fitting.train(CLASSIFIER, classifier, examples, lambda checkpoint: None)

    examples = [encoder.parameters(item) for item in data]
    _measure(parameters, examples)
    generator = seeded(context.seed, "start", 0)
    shares = np.array_split(np.arange(config.components), len(examples))
    for item, components in zip(examples, shares, strict=True):
        parameters.start(item.batch(slice(None)), components.tolist(), generator)
    # A checkpoint has a card once both its networks are there.
    complete = partial(write_card, card=card)
    fitting.train(PARAMETERS, parameters, examples, complete, shares[0].tolist())
    return fitting.checkpoints


def load_policy(
    config: PrimePolicySettings, checkpoint: Path, context: ModelContext
) -> PrimePolicy:
    """Load a checkpoint that `fit_policy` left."""
    check_card(checkpoint, _card(config, context))
    encoder = CallEncoder(context.description, context.space, pair=False)
    classifier, parameters = _build(config, encoder, context, seed=0)
    load_weights(classifier, checkpoint / f"{CLASSIFIER}.safetensors")
    load_weights(parameters, checkpoint / f"{PARAMETERS}.safetensors")
    return PrimePolicy(context.space, encoder, classifier, parameters)


class _Fitting:
    """Pretrains and fine-tunes networks into checkpoints."""

    def __init__(self, config: PrimePolicySettings, trainer: Trainer) -> None:
        self._config, self._trainer = config, trainer
        folder = trainer.context.folder
        epochs = range(1, config.finetuning_epochs + 1)
        self.checkpoints = [folder / f"checkpoint_{epoch:02d}" for epoch in epochs]

    def train(
        self,
        name: str,
        network: Classifier | ParameterNetwork,
        examples: list[Examples],
        complete: Callable[[Path], None],
        pretrained: list[int] | None = None,
    ) -> None:
        """Train a network on rollouts, if there are any, then on demonstrations.

        Args:
            name: Of the network.
            network: What is trained.
            examples: Of rollouts, if it is pretrained, and of demonstrations.
            complete: Called with each checkpoint once the network's weights are in it.
            pretrained: Components that take part in pretraining; the others join afterwards.
        """
        config = self._config
        if len(examples) > 1:
            _activate(network, pretrained)
            schedule = building.schedule(config, config.pretraining_epochs)
            self._trainer.train(f"{name}.pretrained", network, examples[0], schedule)
        _activate(network, None)
        schedule = building.schedule(config, config.finetuning_epochs)
        schedule = replace(schedule, steps_per_epoch=config.finetuning_steps_per_epoch)
        keep = partial(self._keep, name, network, complete)
        self._trainer.train(name, network, examples[-1], schedule, keep)

    def _keep(
        self, name: str, network: nn.Module, complete: Callable[[Path], None], epoch: int
    ) -> None:
        checkpoint = self.checkpoints[epoch - 1]
        checkpoint.mkdir(exist_ok=True)
        notes = {"identity": self._trainer.identity}
        write_tensors(checkpoint / f"{name}.safetensors", network.state_dict(), notes)
        complete(checkpoint)


def _activate(network: Classifier | ParameterNetwork, components: list[int] | None) -> None:
    """Let some components of mixtures take part, or all."""
    if isinstance(network, ParameterNetwork):
        for mixture in network.mixtures:
            mixture.active.fill_(1.0 if components is None else 0.0)
            if components is not None:
                mixture.active[components] = 1.0


def _measure(network: Classifier | ParameterNetwork, examples: list[Examples]) -> None:
    """Normalise by rollouts and demonstrations together."""
    offsets = np.cumsum([0, *(len(item.features) for item in examples)])[:-1]
    rows = [item.rows + int(offset) for item, offset in zip(examples, offsets, strict=True)]
    network.trunk.measure(torch.cat([item.features for item in examples]), torch.cat(rows))


def _build(
    config: PrimePolicySettings, encoder: CallEncoder, context: ModelContext, seed: int
) -> tuple[Classifier, ParameterNetwork]:
    width = encoder.features.width
    return (
        building.build_classifier(config, width, False, len(context.space.names), seed),
        building.build_parameter_network(
            config, width, encoder.frames, context.space, seed, pair=False
        ),
    )


def _card(config: PrimePolicySettings, context: ModelContext) -> Card:
    return make_card(KIND, config.model_dump(mode="json"), context.description, context.space)

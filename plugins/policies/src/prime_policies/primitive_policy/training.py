"""How the policy ``prime`` is trained and loaded."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch

from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.networks.network import Network
from prime_policies.primitive_policy.policy import PrimePolicy
from prime_policies.primitive_policy.settings import PrimePolicySettings
from prime_policies.training.call_networks import CLASSIFIER, PARAMETERS, CallNetworks
from prime_policies.training.examples import Examples, fingerprint
from prime_policies.training.loop import Trainer
from prime_policies.training.repeatable import seeded
from prime_policies.training.weights import Card, write_card

KIND = "prime"


def fit_policy(
    config: PrimePolicySettings,
    rollouts: CallData | None,
    demonstrations: CallData,
    context: TrainingContext,
) -> list[Path]:
    """Train the classifier, then the parameters; see `PrimitivePolicyConfig.fit`."""
    data = [demonstrations] if rollouts is None else [rollouts, demonstrations]
    networks = CallNetworks(KIND, config, context, context.seed, pair=False)
    epochs = config.finetuning_epochs + (len(data) - 1) * config.pretraining_epochs
    identity = fingerprint(networks.card, context.seed, data)
    fitting = _Fitting(config, Trainer(context, identity, 2 * epochs), networks.card)

    classifier = networks.classifier
    examples = [networks.examples_of_types(item) for item in data]
    classifier.trunk.measure(torch.cat([item.everything().features for item in examples]))
    fitting.pretrain(CLASSIFIER, classifier, examples)
    fitting.finetune(CLASSIFIER, classifier, examples)

    mixtures = networks.mixtures
    examples = [networks.examples_of_parameters(item) for item in data]
    mixtures.trunk.measure(torch.cat([item.everything().features for item in examples]))
    generator = seeded(context.seed, "start", 0)
    shares = np.array_split(np.arange(config.components), len(data))
    for item, components in zip(examples, shares, strict=True):
        mixtures.start(item.everything(), components.tolist(), generator)
    # Those that start from demonstrations join after pretraining.
    mixtures.activate(shares[0].tolist())
    fitting.pretrain(PARAMETERS, mixtures, examples)
    mixtures.activate(range(config.components))
    fitting.finetune(PARAMETERS, mixtures, examples)
    return [fitting.checkpoint(epoch + 1) for epoch in range(config.finetuning_epochs)]


def load_policy(
    config: PrimePolicySettings, checkpoint: Path, context: ModelContext
) -> PrimePolicy:
    """Load a checkpoint that `fit_policy` left."""
    networks = CallNetworks(KIND, config, context, seed=0, pair=False)
    networks.load(checkpoint)
    return PrimePolicy(networks)


@dataclass
class _Fitting:
    """Pretrains networks on rollouts, if there are any, and fine-tunes them into checkpoints."""

    config: PrimePolicySettings
    trainer: Trainer
    card: Card

    def checkpoint(self, epoch: int) -> Path:
        return self.trainer.context.folder / f"checkpoint_{epoch:02d}"

    def pretrain(self, name: str, network: Network, examples: list[Examples]) -> None:
        if len(examples) > 1:
            name, epochs = f"{name}.pretrained", self.config.pretraining_epochs
            self.trainer.train(name, network, examples[0], self.config, epochs)

    def finetune(self, name: str, network: Network, examples: list[Examples]) -> None:
        def keep(epoch: int) -> None:
            weights = self.checkpoint(epoch) / f"{name}.safetensors"
            self.trainer.write(weights, network.state_dict())
            if name == PARAMETERS:  # with it a checkpoint is complete
                write_card(weights.parent, self.card)

        config = self.config
        settings = config.model_copy(update={"steps_per_epoch": config.finetuning_steps_per_epoch})
        self.trainer.train(name, network, examples[-1], settings, config.finetuning_epochs, keep)

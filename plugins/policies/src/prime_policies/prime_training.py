"""How the policy ``prime`` is trained and loaded."""

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies import building, examples, preparing
from prime_policies.copies import CopiedFeatures, fit_copies
from prime_policies.examples import Source
from prime_policies.line_inputs import LineInputs
from prime_policies.networks import Classifier, ParameterNetwork
from prime_policies.parameter_codec import ParameterCodec
from prime_policies.prime import PrimePolicyConfig
from prime_policies.prime_model import PrimePolicy
from prime_policies.scene_features import FeatureEncoder, gripper_yaw
from prime_policies.training import Schedule
from prime_policies.training_folder import TrainingFolder
from prime_policies.weights import (
    check_card,
    load_weights,
    make_card,
    write_card,
    write_tensors,
)

KIND = "prime"
CLASSIFIER = "classifier"
PARAMETERS = "parameters"


def fit_policy(
    config: PrimePolicyConfig,
    rollouts: CallData | None,
    demonstrations: CallData,
    context: TrainingContext,
) -> list[Path]:
    """Train the classifier, then the parameters; see `PolicyConfig.fit`."""
    description, space = context.description, context.space
    folder, seed, progress = context.folder, context.seed, context.progress
    folder.mkdir(parents=True, exist_ok=True)
    card = make_card(KIND, config.model_dump(mode="json"), description, space)
    explored = [rollouts] if config.pretrain and rollouts is not None else []
    data, pretrained = [*explored, demonstrations], bool(explored)
    identity = examples.fingerprint(card, seed, [array for part in data for array in _arrays(part)])
    epochs = 2 * (config.finetuning_epochs + pretrained * config.pretraining_epochs)
    trainings = TrainingFolder(folder, identity, seed, progress, epochs)
    trainer = _PolicyTrainer(config, trainings, pretrained)
    encoder = FeatureEncoder(description)
    features = [torch.from_numpy(encoder.encode(part.observations)) for part in data]
    classifier, parameter_network = _build(config, encoder, space, seed)

    pairs = list(zip(data, features, strict=True))
    sources = [_type_source(part, encoded) for part, encoded in pairs]
    preparing.measure_inputs(classifier.trunk, _all_of(sources))
    trainer.pretrain(CLASSIFIER, classifier, sources)
    trainer.finetune(CLASSIFIER, classifier, sources, lambda checkpoint: None)

    sources = [_parameter_source(part, encoded, space) for part, encoded in pairs]
    preparing.measure_inputs(parameter_network.trunk, _all_of(sources))
    blocks, copied = _blocks(config.components, len(sources)), CopiedFeatures.of(encoder)
    for source, components in zip(sources, blocks, strict=True):
        # One component is left for outliers: the first line again, wider.
        fit = partial(fit_copies, features=copied, maximum=len(components) - 1)
        preparing.fit_lines(parameter_network, source, space, fit, components)
    parameter_network.active[blocks[0].stop :] = 0.0
    trainer.pretrain(PARAMETERS, parameter_network, sources)
    parameter_network.active.fill_(1.0)
    # A checkpoint has a card once both its networks are there.
    complete = partial(write_card, card=card)
    trainer.finetune(PARAMETERS, parameter_network, sources, complete)
    return trainer.checkpoints


def load_policy(
    config: PrimePolicyConfig,
    checkpoint: Path,
    context: ModelContext,
) -> PrimePolicy:
    """Load a checkpoint that `fit_policy` left."""
    description, space = context.description, context.space
    check_card(checkpoint, make_card(KIND, config.model_dump(mode="json"), description, space))
    encoder = FeatureEncoder(description)
    classifier, parameter_network = _build(config, encoder, space, seed=0)
    load_weights(classifier, checkpoint / f"{CLASSIFIER}.safetensors")
    load_weights(parameter_network, checkpoint / f"{PARAMETERS}.safetensors")
    return PrimePolicy(description, space, classifier, parameter_network)


class _PolicyTrainer:
    """Pretrains and fine-tunes networks into checkpoints."""

    def __init__(
        self, config: PrimePolicyConfig, trainings: TrainingFolder, pretrained: bool
    ) -> None:
        self._config, self._trainings, self._pretrained = config, trainings, pretrained

    @property
    def checkpoints(self) -> list[Path]:
        """The folders of the checkpoints, oldest first."""
        epochs = range(1, self._config.finetuning_epochs + 1)
        return [self._trainings.folder / f"checkpoint_{epoch:02d}" for epoch in epochs]

    def pretrain(
        self, name: str, network: Classifier | ParameterNetwork, sources: list[Source]
    ) -> None:
        """Train a network on the first source, if it is pretrained."""
        config = self._config
        if self._pretrained:
            batches = [(sources[0], config.batch_size)]
            schedule = building.schedule(config, config.pretraining_epochs)
            self._trainings.train(f"{name}.pretrained", network, batches, schedule)

    def finetune(
        self,
        name: str,
        network: Classifier | ParameterNetwork,
        sources: list[Source],
        complete: Callable[[Path], None],
    ) -> None:
        """Train a network on the last source, and keep a checkpoint after each epoch.

        Args:
            name: Of the network.
            network: What is trained.
            sources: Rollouts, if it is pretrained, and demonstrations.
            complete: Called with each checkpoint once the network's weights are in it.
        """

        def keep(epoch: int) -> None:
            checkpoint = self.checkpoints[epoch - 1]
            checkpoint.mkdir(exist_ok=True)
            notes = {"identity": self._trainings.identity}
            write_tensors(checkpoint / f"{name}.safetensors", network.state_dict(), notes)
            complete(checkpoint)

        self._trainings.train(name, network, self._mixed(sources), self._finetuning(), keep)

    def _finetuning(self) -> Schedule:
        config = self._config
        rate = config.finetuning_learning_rate if self._pretrained else config.learning_rate
        steps = config.finetuning_steps_per_epoch
        return Schedule(config.finetuning_epochs, steps, rate, config.weight_decay)

    def _mixed(self, sources: list[Source]) -> list[tuple[Source, int]]:
        """Return how many examples of a fine-tuning batch come from each source.

        One at least comes from the demonstrations.
        """
        size = self._config.batch_size
        share = self._config.rollout_share if self._pretrained else 0.0
        from_rollouts = min(round(size * share), size - 1)
        batches = [(sources[-1], size - from_rollouts)]
        return [*batches, (sources[0], from_rollouts)] if from_rollouts else batches


def _build(
    config: PrimePolicyConfig, encoder: FeatureEncoder, space: PrimitiveSpace, seed: int
) -> tuple[Classifier, ParameterNetwork]:
    classes = len(space.names)
    classifier = building.start_network(
        lambda: building.build_classifier(config, encoder.width, False, classes), seed, CLASSIFIER
    )
    inputs = LineInputs.of(encoder, pair=False)
    parameter_network = building.start_network(
        lambda: building.build_parameter_network(config, inputs, space), seed, PARAMETERS
    )
    return classifier, parameter_network


def _type_source(data: CallData, features: Tensor) -> Source:
    return examples.classifier_source(
        features, data.types.rows, data.types.classes, data.types.weights
    )


def _parameter_source(data: CallData, features: Tensor, space: PrimitiveSpace) -> Source:
    yaws = gripper_yaw(data.observations)[data.parameters.rows[:, 0]]
    targets = ParameterCodec(space).targets(data.values, data.parameters.classes, yaws)
    return examples.parameter_source(
        features,
        data.parameters.rows[:, 0],
        data.parameters.classes,
        targets,
        data.parameters.weights,
    )


def _blocks(components: int, sources: int) -> list[range]:
    """Share components out among sources."""
    edges = [components * number // sources for number in range(sources + 1)]
    return [range(*edge) for edge in pairwise(edges)]


def _all_of(sources: list[Source]) -> Source:
    """Join sources, to measure what inputs there are."""
    offsets = np.cumsum([0, *(len(source.features) for source in sources)])
    return Source(
        features=torch.cat([source.features for source in sources]),
        indices=torch.cat(
            [
                source.indices + int(offset)
                for source, offset in zip(sources, offsets[:-1], strict=True)
            ]
        ),
        labels=torch.cat([source.labels for source in sources]),
        targets=torch.cat([source.targets for source in sources]),
        weights=np.concatenate([source.weights for source in sources]),
    )


def _arrays(data: CallData) -> list[NDArray[np.generic]]:
    arrays: list[NDArray[np.generic]] = [
        data.observations.state,
        data.observations.environment_state,
    ]
    arrays += [data.types.rows, data.types.classes, data.types.weights, data.parameters.rows[:, 0]]
    return [*arrays, data.parameters.classes, data.values, data.parameters.weights]

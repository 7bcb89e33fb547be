"""The stages that models of images depend on, and which models are such."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from prime_core.collection.rollouts import FrameConfig
from prime_core.contracts.idm import IdmConfig
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.policy import PolicyConfig
from prime_core.experiments.settings import ExperimentConfig, ModelName
from prime_core.experiments.stages.collection import Collection
from prime_core.experiments.stages.demonstrations import Demonstrations
from prime_core.experiments.stages.idm import IdmTraining
from prime_core.experiments.stages.images import CollectionImages, DemonstrationImages
from prime_core.experiments.stages.parsing import Parsing
from prime_core.experiments.stages.perception import PerceptionTraining
from prime_core.experiments.stages.policy import PolicyTraining
from prime_core.experiments.stages.randomised_images import RandomisedImages
from prime_core.experiments.stages.stage import Stage
from prime_core.registry.fields import dump_choice


@dataclass(frozen=True)
class ImageStages:
    """The stages that make images, and the one that trains what tells object poses from them.

    They run where a model needs them.

    Attributes:
        config: The experiment.
        rollouts: Makes images of rollouts, for perceptions and policies.
        pairs: Makes images of the pairs that an IDM learns from.
        demonstrations: Makes images of demonstrations.
        perception: Trains the perception; None if none is asked for.
    """

    config: ExperimentConfig
    rollouts: CollectionImages
    pairs: CollectionImages
    demonstrations: DemonstrationImages
    perception: PerceptionTraining | None

    def perception_of(
        self, name: ModelName, config: IdmConfig | PolicyConfig
    ) -> PerceptionTraining | None:
        """Return what tells a model object poses; None for the simulator, or if it needs none."""
        return self.perception if self.config.is_perceived(name, config) else None

    def needed(
        self, idm: IdmTraining, parsing: Parsing, trainings: Iterable[PolicyTraining]
    ) -> dict[str, Stage]:
        """Return those that the models of some stages need, by name."""
        used: list[Stage | None] = [parsing.images]
        for training in trainings:
            used += [training.rollout_images, training.images]
        if self.perception is not None:
            used.append(self.perception.images)
        stages: dict[str, Stage] = {}
        if any(isinstance(stage, CollectionImages) for stage in used):
            stages["images.rollouts"] = self.rollouts
        if idm.rollout_images is not None:
            stages["images.pairs"] = self.pairs
        if any(isinstance(stage, DemonstrationImages) for stage in used):
            stages["images.demonstrations"] = self.demonstrations
        if self.perception is not None:
            if self.perception.randomised is not None:
                stages["images.randomised"] = self.perception.randomised
            stages["perception"] = self.perception
        return stages


def image_stages(
    config: ExperimentConfig,
    make: Callable[..., Any],
    collection: Collection,
    demonstrations: Demonstrations,
) -> ImageStages:
    """Make the stages of an experiment that have to do with images.

    Args:
        config: The experiment.
        make: Makes a stage of a class and its fields.
        collection: Where rollouts come from.
        demonstrations: Where demonstrations come from.
    """
    cameras = config.images.model_dump(mode="json", include=set(CameraConfig.model_fields))
    within = FrameConfig(within=config.images.frames_within, others=False)
    ends = FrameConfig(around=config.pairs.around, most_others=config.images.other_pairs)
    rollouts, pairs = (
        make(
            CollectionImages,
            collection=collection,
            cameras=cameras,
            frames=frames.model_dump(mode="json", exclude_none=True),
        )
        for frames in (within, ends)
    )
    shown = make(DemonstrationImages, demonstrations=demonstrations, cameras=cameras)
    perception = None
    if config.perception is not None:
        images = rollouts if config.perception.taught_on == "rollouts" else shown
        share = config.images.randomised_share
        randomised = None
        if share:
            randomised = make(
                RandomisedImages, images=images, cameras=cameras, share=share, seed=config.seed
            )
        perception = make(
            PerceptionTraining,
            images=images,
            randomised=randomised,
            perception=dump_choice(config.perception),
            seed=config.seed,
            device=config.compute.device,
        )
    return ImageStages(config, rollouts, pairs, shown, perception)

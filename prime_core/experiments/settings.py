"""The schema of an experiment."""

import re
from functools import cached_property
from typing import Any, Literal, Self

from pydantic import Field, TypeAdapter, field_validator, model_validator

from prime_core.collection.settings import CollectionConfig
from prime_core.configuration import Config, Count, Seed, Share
from prime_core.contracts.idm import IdmConfig
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.policy import MotorPolicyConfig, PolicyConfig
from prime_core.execution.settings import EvaluationConfig
from prime_core.experiments.compute import ComputeConfig
from prime_core.experiments.variants import Changes, with_changes
from prime_core.learning.augmentation import AugmentationConfig
from prime_core.learning.training_pairs import PairConfig
from prime_core.registry.fields import (
    DemonstratorChoice,
    EnvironmentChoice,
    IdmChoice,
    ParserChoice,
    PerceptionChoice,
    PolicyChoice,
    PrimitiveChoice,
)

ModelName = Literal["idm", "policies"]


class CollectionPlaces(CollectionConfig):
    """How rollouts are collected, and where."""

    environments: tuple[EnvironmentChoice, ...] = ()
    """Where to collect: episode n in environment n modulo their number. None given: where the task
    is. Their objects, robots and workspaces must be those of the task's environment."""


class ImageConfig(CameraConfig):
    """What models that see images see through, and which frames have images."""

    frames_within: int = Field(8, ge=0, le=1000)
    """Of each rollout, evenly apart, besides those at its ends: images tell more apart than poses
    do, and the first frames of rollouts alone are too few to learn them from."""
    randomised_share: Share = 0.4
    """Of those frames that a perception is also shown with objects elsewhere, and fallen."""
    other_pairs: Count = 10
    """Pairs of `other` of each episode, at most, that an IDM of images learns from: each has images
    of its own."""


class ExperimentConfig(Config):
    """An experiment: what a YAML file holds."""

    name: str
    """Of the folder under ``runs/``."""
    seed: Seed = 0
    """Of demonstrations, collection and the IDM."""
    environment: EnvironmentChoice
    """Where the task is."""
    primitives: tuple[PrimitiveChoice, ...] = Field(min_length=1)
    """The library of primitives."""
    demonstrations: DemonstratorChoice
    """Where the demonstrations come from."""
    strict: bool = False
    """Whether a demonstration that cannot be used is an error; else it is left out and listed."""
    collection: CollectionPlaces = CollectionPlaces()
    """How random rollouts are collected."""
    images: ImageConfig = ImageConfig()
    """What models that see images see through."""
    perception: PerceptionChoice | None = None
    """What tells object poses from images; None where models get the simulator's."""
    perceived_by: tuple[ModelName, ...] = Field(("idm", "policies"), min_length=1)
    """Which models get their object poses from the perception, if there is one; the others get the
    simulator's."""
    pairs: PairConfig = PairConfig()
    """What the IDM is trained on."""
    idm: IdmChoice
    """The inverse dynamics model."""
    parser: ParserChoice
    """The parser."""
    augmentation: AugmentationConfig = AugmentationConfig()
    """What the policies are trained on."""
    policies: dict[str, PolicyChoice] = Field(min_length=1)
    """Policies to train and compare, by names of your choice."""
    seeds: tuple[Seed, ...] = Field((1, 2, 3), min_length=1)
    """Of the policies' trainings."""
    evaluation: EvaluationConfig = EvaluationConfig()
    """How policies are evaluated."""
    compute: ComputeConfig = ComputeConfig()
    """Where the experiment runs."""
    variants: dict[str, Changes] = Field(default_factory=dict)
    """The experiment with some keys changed, by names of your choice."""

    @field_validator("name")
    @classmethod
    def _name_is_a_folder(cls, name: str) -> str:
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,99}", name):
            raise ValueError(
                f"found {name!r}: use letters, digits, '-', '_' and '.' only, 100 at most"
            )
        return name

    @field_validator("policies", "variants")
    @classmethod
    def _names_are_words(cls, named: dict[str, Any]) -> dict[str, Any]:
        for name in named:
            if not re.fullmatch(r"[A-Za-z0-9_-]{1,99}", name):
                raise ValueError(
                    f"found the name {name!r}: use letters, digits, '-', '_' only, 99 at most"
                )
        return named

    @field_validator("seeds")
    @classmethod
    def _seeds_differ(cls, seeds: tuple[Seed, ...]) -> tuple[int, ...]:
        if len(set(seeds)) != len(seeds):
            raise ValueError(f"found {list(seeds)}: each seed may be named once only")
        return seeds

    @model_validator(mode="after")
    def _rollouts_show_motor_policies_no_images(self) -> Self:
        for name, policy in self.policies.items():
            pretrained = isinstance(policy, MotorPolicyConfig) and policy.pretrain
            if pretrained and self.sees_images("policies", policy):
                raise ValueError(
                    f"policies.{name}.pretrain: found true for a policy over motor actions that "
                    "sees images: it would need an image of every frame of the rollouts, and few "
                    "have one. Set it to false, or let the policy see the simulator's poses: no "
                    "'perception', or 'perceived_by: [idm]'"
                )
        return self

    @model_validator(mode="after")
    def _variants_are_experiments(self) -> Self:
        _ = self.resolved_variants
        return self

    def is_perceived(self, name: ModelName, config: IdmConfig | PolicyConfig) -> bool:
        """Whether a model is told object poses by the perception."""
        needs_poses = "images" not in config.modalities
        return needs_poses and self.perception is not None and name in self.perceived_by

    def sees_images(self, name: ModelName, config: IdmConfig | PolicyConfig) -> bool:
        """Whether a model sees images, itself or through the perception."""
        return "images" in config.modalities or self.is_perceived(name, config)

    @cached_property
    def resolved_variants(self) -> dict[str, "ExperimentConfig"]:
        """The experiments that the variants are, by their names.

        Raises:
            pydantic.ValidationError: If one is wrong; its place begins with ``variants``.
        """
        if not self.variants:
            return {}
        data = self.model_dump(mode="json", exclude={"variants"})
        changed = {name: with_changes(data, changes) for name, changes in self.variants.items()}
        # In mappings as in the experiment, so that the place of a mistake reads as it does there.
        places = TypeAdapter(dict[str, dict[str, ExperimentConfig]])
        return places.validate_python({"variants": changed})["variants"]

"""Settings of learned primitives."""

from pathlib import Path
from typing import Annotated, Any, ClassVar, Self

import numpy as np
import yaml
from pydantic import Field, StringConstraints, ValidationError, field_validator

from prime_core.configuration import Config
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.policy import MotorPolicy, MotorPolicyConfig, PolicyConfig
from prime_core.contracts.primitive import (
    LearnedPrimitiveConfig,
    PrimitiveExamples,
    PrimitiveTraining,
)
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.errors import WeightsError
from prime_core.files import new_file
from prime_core.registry.fields import PolicyChoice, dump_choice
from prime_primitives_learned.examples import motor_demonstrations
from prime_primitives_learned.frame import ParameterPlaces
from prime_primitives_learned.primitive import LearnedPrimitive
from prime_primitives_learned.settings import Tolerances
from prime_primitives_learned.statistics import SegmentStatistics, statistics_of

CARD = "primitive.yaml"
"""What a trained primitive is, beside the weights of its policy."""
POLICY = "policy"
"""Folder of the weights."""

Name = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_-]*$")]


class TrainedPrimitive(Config):
    """What is kept of a trained primitive, but for weights."""

    statistics: SegmentStatistics
    policy: PolicyChoice
    checkpoint: str
    """Of the policy, within the folder."""


def _default_policy() -> dict[str, Any]:
    """Return a small network for a short training: it learns one motion from thirty segments.

    robomimic's least deviation, 1e-4, is for long trainings: with it the likelihood is won by
    the two numbers of an action that are -1 or 1, and the others are hardly learned.
    """
    return {
        "type": "bc-rnn",
        "hidden": 100,
        "learning_rate": 1e-3,
        "minimum_deviation": 0.05,
        "epochs": 8,
    }


class LearnedConfig(Tolerances, LearnedPrimitiveConfig):
    """Settings of a learned primitive."""

    name: Name | None = None
    """What primitive calls name it by; null for the name of the segments."""
    policy: PolicyChoice = Field(default_factory=_default_policy, validate_default=True)
    """The policy over motor actions that moves the arm; of a trained one it is the one trained."""

    @field_validator("policy")
    @classmethod
    def _moves_the_arm(cls, policy: PolicyConfig) -> PolicyConfig:
        if not isinstance(policy, MotorPolicyConfig):
            raise ValueError("it must be a policy over motor actions, such as bc-rnn")
        if policy.pretrain:
            raise ValueError("pretrain is true: a primitive has no rollouts to learn from first")
        if "images" in policy.modalities:
            raise ValueError("it sees images, which learned primitives are not given")
        return policy

    def with_trained(self, folder: Path) -> Self:
        """Return the settings with what was trained; see `LearnedPrimitiveConfig`."""
        own = self.model_dump(exclude_defaults=True, exclude={"segments", "policy"})
        return type(self)(**own, trained=folder)  # the folder says which policy it is

    @property
    def called(self) -> str:
        """What primitive calls name it by."""
        return self.name or self.learns

    def fit(self, examples: PrimitiveExamples, training: PrimitiveTraining) -> None:
        """Train the primitive; see `LearnedPrimitiveConfig`."""
        context = TrainingContext(
            description=ParameterPlaces(examples.space).description,
            space=PrimitiveSpace((), ()),
            device=training.device,
            folder=training.folder / POLICY,
            seed=training.seed,
            progress=training.progress,
        )
        policy, generator = self._motor_policy, np.random.default_rng([training.seed, 0])
        checkpoints = policy.fit(None, motor_demonstrations(examples, generator), context)
        card = TrainedPrimitive(
            statistics=statistics_of(examples),
            policy=policy,
            checkpoint=checkpoints[-1].relative_to(training.folder).as_posix(),
        )
        with new_file(training.folder / CARD) as partial:
            text = yaml.safe_dump(card.model_dump(mode="json"), sort_keys=False)
            partial.write_text(text, encoding="utf-8")

    def build(self, description: SceneDescription) -> LearnedPrimitive:
        """Make the primitive; see `PrimitiveConfig`.

        Raises:
            WeightsError: If it was not trained, or is none that learns the segments of this type.
        """
        if self.trained is None:
            raise WeightsError(
                f"primitive {self.called!r} is not trained yet: its stage comes first"
            )
        card = _read_card(self.trained)
        learned = card.statistics.name
        if learned != self.learns:
            raise WeightsError(
                f"{self.trained / CARD} is of a primitive that learned {learned!r}, not "
                f"{self.learns!r}: name its own type or folder"
            )
        policy = _load(card, self.trained)
        return LearnedPrimitive(self.called, card.statistics, policy, self, description)

    @property
    def _motor_policy(self) -> MotorPolicyConfig:
        assert isinstance(self.policy, MotorPolicyConfig), "the validator saw to it"
        return self.policy


class NamedConfig(LearnedConfig):
    """Settings of a primitive whose type says what its segments are called."""

    shows: ClassVar[str]
    """Name of the segments that it learns from."""

    @classmethod
    def for_segments(cls, name: str, segments: Path) -> Self | None:
        """Return settings that learn the segments of a name; see `LearnedPrimitiveConfig`."""
        return cls(segments=segments) if name == cls.shows else None

    @property
    def learns(self) -> str:
        """Name of the segments that it learns from."""
        return self.shows


class ReachConfig(NamedConfig):
    """Settings of a learned reach."""

    shows = "reach"


class GraspConfig(NamedConfig):
    """Settings of a learned grasp."""

    shows = "grasp"


class PlaceConfig(NamedConfig):
    """Settings of a learned place."""

    shows = "place"


class PushConfig(NamedConfig):
    """Settings of a learned push."""

    shows = "push"


class AnyConfig(LearnedConfig):
    """Settings of a primitive that learns segments of any name."""

    learn: Name
    """Name of the segments that it learns from."""

    @classmethod
    def for_segments(cls, name: str, segments: Path) -> Self | None:
        """Return settings that learn the segments of a name; see `LearnedPrimitiveConfig`."""
        return cls(learn=name, segments=segments)

    @property
    def learns(self) -> str:
        """Name of the segments that it learns from."""
        return self.learn


def _read_card(folder: Path) -> TrainedPrimitive:
    path = folder / CARD
    if not path.is_file():
        raise WeightsError(
            f"{folder} holds no trained primitive: {CARD} is missing. Name a folder that 'prime "
            "learn-primitives' wrote, such as primitives/grasp"
        )
    try:
        return TrainedPrimitive.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")))
    except (yaml.YAMLError, UnicodeDecodeError, ValidationError) as error:
        raise WeightsError(f"{path} is not what a training wrote: {error}") from error


def _load(card: TrainedPrimitive, folder: Path) -> MotorPolicy:
    policy = card.policy
    if not isinstance(policy, MotorPolicyConfig):
        raise WeightsError(
            f"{folder / CARD}: policy is {dump_choice(policy)['type']!r}, which moves no arm"
        )
    context = ModelContext(
        description=ParameterPlaces(card.statistics.space).description, space=PrimitiveSpace((), ())
    )
    return policy.load(folder / card.checkpoint, context)

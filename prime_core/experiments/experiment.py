"""Wires the stages of an experiment."""

import hashlib
import json
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from prime_core.configuration import ConfigDump
from prime_core.contracts.policy import MotorPolicyConfig, PolicyConfig, PrimitivePolicyConfig
from prime_core.errors import ConfigurationError
from prime_core.execution.settings import EvaluationConfig
from prime_core.experiments.image_stages import image_stages
from prime_core.experiments.run_folder.code import Code, digest_of
from prime_core.experiments.run_folder.code_mark import CodeMark, marks_beside
from prime_core.experiments.run_folder.contents import content_of
from prime_core.experiments.run_folder.settings_of import settings_in
from prime_core.experiments.settings import ExperimentConfig
from prime_core.experiments.stages.collection import Collection
from prime_core.experiments.stages.demonstrations import Demonstrations
from prime_core.experiments.stages.evaluation import Evaluation
from prime_core.experiments.stages.idm import IdmTraining
from prime_core.experiments.stages.learned_primitives import LearnedPrimitives, untrained
from prime_core.experiments.stages.motor_policy import MotorPolicyTraining
from prime_core.experiments.stages.outputs.export import Export
from prime_core.experiments.stages.outputs.video import Video
from prime_core.experiments.stages.parsing import Parsing
from prime_core.experiments.stages.primitive_policy import PrimitivePolicyTraining
from prime_core.experiments.stages.replay import Replaying
from prime_core.experiments.stages.stage import Stage
from prime_core.registry.fields import dump_choice


class Experiment:
    """The stages of an experiment, in the order they run in.

    Args:
        config: The experiment.
        folder: Where it keeps everything; it need not be there.
        remake: Whether stages that other code made are others, to be made anew.

    Attributes:
        config: The experiment.
        folder: Where it keeps everything.
        images: The stages that have to do with images.
        variants: The experiments that its variants are, by name, in the same folder.
    """

    def __init__(self, config: ExperimentConfig, folder: Path, *, remake: bool = False) -> None:
        self.config = config
        self.folder = folder.resolve()
        self._remake = remake
        environment, seed = dump_choice(config.environment), config.seed
        demonstrator = dump_choice(config.demonstrations)
        self.demonstrations = self._stage(
            Demonstrations, environment=environment, demonstrator=demonstrator, seed=seed
        )
        primitives = tuple(map(dump_choice, config.primitives))
        self.learned = self._learned(primitives)
        self.collection = self._stage(
            Collection,
            environments=tuple(map(dump_choice, config.collection.environments)) or (environment,),
            primitives=primitives,
            learned=self.learned,
            settings=config.collection.model_dump(mode="json", exclude={"environments"}),
            seed=config.seed,
        )
        self.images = image_stages(config, self._stage, self.collection, self.demonstrations)
        images = self.images
        sees_images = config.sees_images("idm", config.idm)
        self.idm = self._stage(
            IdmTraining,
            collection=self.collection,
            rollout_images=images.pairs if sees_images else None,
            perception=images.perception_of("idm", config.idm),
            pairs=config.pairs.model_dump(mode="json"),
            idm=dump_choice(config.idm),
            seed=config.seed,
            device=config.compute.device,
        )
        self.parsing = self._stage(
            Parsing,
            demonstrations=self.demonstrations,
            idm=self.idm,
            images=images.demonstrations if sees_images else None,
            parser=dump_choice(config.parser),
        )
        self.replay = self._stage(Replaying, parsing=self.parsing)
        self.evaluations: dict[str, Evaluation] = {}
        self.videos: dict[str, Video] = {}
        for name, policy in config.policies.items():
            training = self._training(policy)
            self.evaluations[name] = self._stage(
                Evaluation,
                training=training,
                settings=_evaluation_settings(config.evaluation, policy),
            )
            self.videos[name] = self._stage(
                Video,
                training=training,
                runner=config.evaluation.runner.model_dump(mode="json"),
                maximum_steps=config.evaluation.maximum_steps,
            )
        self.export = self._export()
        self.variants = {
            name: Experiment(variant, folder, remake=remake)
            for name, variant in config.resolved_variants.items()
        }

    def _learned(self, primitives: tuple[ConfigDump, ...]) -> LearnedPrimitives | None:
        """Return the stage that trains primitives, or None where none is to be trained."""
        config, found = self.config, untrained(primitives)
        if not found:
            return None
        device = config.compute.device
        return self._stage(LearnedPrimitives, primitives=found, seed=config.seed, device=device)

    def _training(self, policy: PolicyConfig) -> PrimitivePolicyTraining | MotorPolicyTraining:
        """Return the stage that trains a policy of either kind."""
        config = self.config
        common: dict[str, Any] = {
            "policy": dump_choice(policy),
            "seeds": config.seeds,
            "device": config.compute.device,
            "perception": self.images.perception_of("policies", policy),
        }
        sees_images = config.sees_images("policies", policy)
        images = self.images.demonstrations if sees_images else None
        if isinstance(policy, MotorPolicyConfig):
            return self._stage(
                MotorPolicyTraining,
                demonstrations=self.demonstrations,
                collection=self.collection if policy.pretrain else None,
                images=images,
                **common,
            )
        pretrained = isinstance(policy, PrimitivePolicyConfig) and policy.pretrain
        return self._stage(
            PrimitivePolicyTraining,
            parsing=self.parsing,
            images=images,
            rollout_images=self.images.rollouts if images and pretrained else None,
            augmentation=config.augmentation.model_dump(mode="json"),
            **common,
        )

    def _export(self) -> Export:
        """Return the stage that exports, with images where a model sees those of demonstrations."""
        has_images = "images.demonstrations" in self._image_stages()
        images = self.images.demonstrations if has_images else None
        return self._stage(Export, parsing=self.parsing, images=images)

    def _image_stages(self) -> dict[str, Stage]:
        """Return the stages of images that the models need, by name."""
        trainings = [each.training for each in self.evaluations.values()]
        return self.images.needed(self.idm, self.parsing, trainings)

    def _stage[AnyStage: Stage](self, kind: type[AnyStage], **fields: Any) -> AnyStage:
        """Return a stage, as the code of now made it, or else as other code made it last."""
        content = content_of(settings_in(fields))
        make = partial(
            kind, content=content, infra=self.config.compute.infra(self.folder / "stages"), **fields
        )
        stage = make()
        marks = marks_beside(stage.folder, stage.family)
        version = _version(marks, stage.code_now(), remake=self._remake)
        return make(code=version) if version else stage

    @property
    def identity(self) -> str:
        """What all results depend on, as a digest: settings, code and content of files."""
        text = json.dumps(self.uids, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def uids(self) -> dict[str, str]:
        """What exca tells stages apart by, for each stage by name."""
        return {name: stage.infra.uid() for name, stage in self.stages.items()}

    @property
    def stages(self) -> dict[str, Stage]:
        """All stages by name, in order.

        Policies and their evaluations are ``policy.NAME``, ``evaluation.NAME`` and
        ``video.NAME``. After the experiment's own come those of variants, ``VARIANT/STAGE``; one
        that depends on the same as an earlier stage is that stage, and not named again.
        """
        stages = self.own_stages
        for name in self.variants:
            known = _identities(stages)
            stages |= {
                f"{name}/{step}": stage
                for step, stage in self.differing(name).items()
                if stage.infra.uid() not in known
            }
        return stages

    def differing(self, variant: str) -> dict[str, Stage]:
        """Return a variant's stages that are none of the experiment's, by their own names.

        What is made for people to look at, export and videos, the experiment makes of itself only.
        """
        known = _identities(self.own_stages)
        return {
            step: stage
            for step, stage in self.variants[variant].own_stages.items()
            if not isinstance(stage, (Export, Video)) and stage.infra.uid() not in known
        }

    @property
    def own_stages(self) -> dict[str, Stage]:
        """The stages without those of variants, by name, in order."""
        stages: dict[str, Stage] = {
            "demonstrations": self.demonstrations,
            **({} if self.learned is None else {"primitives": self.learned}),
            "collection": self.collection,
            **self._image_stages(),
            "idm": self.idm,
            "parsing": self.parsing,
            "export": self.export,
            "replay": self.replay,
        }
        for name, evaluation in self.evaluations.items():
            stages[f"policy.{name}"] = evaluation.training
            stages[f"evaluation.{name}"] = evaluation
            stages[f"video.{name}"] = self.videos[name]
        return stages

    def until(self, last: str | None) -> dict[str, Stage]:
        """Return the stages up to and with one of them, or all.

        Raises:
            ConfigurationError: If there is no such stage.
        """
        stages = self.stages
        if last is None:
            return stages
        if last not in stages:
            raise ConfigurationError(
                f"--until {last}: there is no such stage. There are: {', '.join(stages)}"
            )
        return dict(_through(stages.items(), last))


def _version(marks: list[CodeMark], now: Code, *, remake: bool) -> str:
    """Return the version of a stage to take.

    Args:
        marks: Of the versions that there are, the newest first.
        now: The code that would make the stage.
        remake: Whether it is to be made by this code.
    """
    for mark in marks:
        if mark.made_by == now:
            return mark.version
    if remake and marks:
        return digest_of(now)
    kept = [mark.version for mark in marks if mark.is_kept_for(now)]
    return next(iter([*kept, *(mark.version for mark in marks)]), "")


def _evaluation_settings(config: EvaluationConfig, policy: PolicyConfig) -> ConfigDump:
    """Return settings without the runner's where a policy makes no calls of primitives."""
    makes_no_calls = isinstance(policy, MotorPolicyConfig)
    return config.model_dump(mode="json", exclude={"runner"} if makes_no_calls else None)


def _identities(stages: dict[str, Stage]) -> set[str]:
    """Return what exca tells stages apart by: their kind, and all that they depend on."""
    return {stage.infra.uid() for stage in stages.values()}


def _through(items: Iterable[tuple[str, Stage]], last: str) -> Iterable[tuple[str, Stage]]:
    for name, stage in items:
        yield name, stage
        if name == last:
            return

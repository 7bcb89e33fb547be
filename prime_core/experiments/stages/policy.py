"""What the stages that train policies share: one training for each seed."""

from abc import abstractmethod
from pathlib import Path
from typing import ClassVar

from prime_core.configuration import ConfigDump
from prime_core.contracts.perception import Perception
from prime_core.contracts.policy import MotorPolicy, PolicyConfig
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.deployment.acting import acting_policy
from prime_core.execution.settings import RunnerConfig
from prime_core.execution.world import World
from prime_core.experiments.stages.images import CollectionImages, DemonstrationImages
from prime_core.experiments.stages.perception import PerceptionTraining
from prime_core.experiments.stages.stage import DEVICE_IS_NO_IDENTITY, Stage


class PolicyTraining(Stage):
    """Policies, one seed an item."""

    title: ClassVar[str] = "policy"
    unit: ClassVar[str] = "seeds"

    policy: ConfigDump
    seeds: tuple[int, ...]
    images: DemonstrationImages | None = None
    """Of the demonstrations, where the policy or the perception before it sees images."""
    rollout_images: CollectionImages | None = None
    """Of the rollouts, where it is pretrained on images."""
    perception: PerceptionTraining | None = None
    """What tells the policy object poses; None for the simulator."""
    device: str = "auto"
    _exclude_from_cls_uid: ClassVar[tuple[str, ...]] = DEVICE_IS_NO_IDENTITY

    @property
    @abstractmethod
    def config(self) -> PolicyConfig:
        """Which policy."""

    @abstractmethod
    def build_world(self) -> World:
        """Build where the policy acts."""

    def load(self, checkpoint: Path, world: World, runner: RunnerConfig) -> MotorPolicy:
        """Load a checkpoint as something that acts.

        Args:
            checkpoint: One of `checkpoints`.
            world: From `build_world`.
            runner: How calls of primitives are run, if the policy makes any.
        """
        context, perception = self.context(world), self.load_perception()
        return acting_policy(self.config, checkpoint, context, perception, world.primitives, runner)

    def items(self) -> list[str]:
        """Return the seeds."""
        return [str(seed) for seed in self.seeds]

    def outputs(self, item: str) -> list[Path]:
        """Return where a seed's training keeps its checkpoints."""
        return [self.folder / f"seed-{item}"]

    def checkpoints(self, seed: str) -> list[Path]:
        """Return the checkpoints of a seed, oldest first."""
        (result,) = self.results([seed])
        return [self.folder / name for name in result["checkpoints"]]

    def context(self, world: World) -> ModelContext:
        """Return where the policy is used."""
        images = self.images if "images" in self.config.modalities else None
        return world.context(self.device, None if images is None else images.config)

    def load_perception(self) -> Perception | None:
        """Return what tells the policy object poses, or None for the simulator."""
        return None if self.perception is None else self.perception.load()

    def training_context(self, world: World, item: str) -> TrainingContext:
        """Return where and how the policy of a seed is trained."""
        return TrainingContext(
            **vars(self.context(world)),
            folder=self.folder / f"seed-{item}",
            seed=int(item),
            progress=self.progress_writer(item),
        )

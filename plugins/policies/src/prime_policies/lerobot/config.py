"""What is registered as the policies ``lerobot/act`` and ``lerobot/diffusion``."""

from abc import abstractmethod
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Self

from pydantic import model_validator

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.policy import MotorPolicy
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_policies.lerobot.settings import (
    ActSettings,
    DiffusionSettings,
    LeRobotTrainingSettings,
)
from prime_policies.motor.config import TrainedMotorConfig

if TYPE_CHECKING:
    from prime_policies.lerobot.network import LeRobotNetwork
    from prime_policies.motor.fitting import Design


class LeRobotConfig(TrainedMotorConfig, LeRobotTrainingSettings):
    """A policy of LeRobot's on the features of scenes that our other policies see."""

    packages: ClassVar[tuple[str, ...]] = ("lerobot",)
    """What must be installed beside this pack."""

    @model_validator(mode="after")
    def _is_installed(self) -> Self:
        missing = [name for name in self.packages if find_spec(name) is None]
        if missing:
            raise ValueError(
                f"this policy is LeRobot's own, and {' and '.join(missing)} cannot be found here: "
                "pip install 'prime-policies[lerobot]'"
            )
        return self

    @abstractmethod
    def design(self, scenes: SceneDescription) -> "Design[LeRobotNetwork]":
        """Return what is trained for some scenes."""

    def fit(
        self,
        rollouts: Sequence[Demonstration] | None,
        demonstrations: Sequence[Demonstration],
        context: TrainingContext,
    ) -> Sequence[Path]:
        """Train LeRobot's network on windows of episodes; see `MotorPolicyConfig`."""
        from prime_policies.motor.fitting import fit_network

        design = self.design(context.description)
        return fit_network(design, rollouts if self.pretrain else None, demonstrations, context)

    def load(self, checkpoint: Path, context: ModelContext) -> MotorPolicy:
        """Load the network of a checkpoint; see `MotorPolicyConfig`."""
        from prime_policies.lerobot.policy import LeRobotPolicy
        from prime_policies.motor.fitting import load_network

        design = self.design(context.description)
        return LeRobotPolicy(*load_network(design, checkpoint, context))


class ActConfig(ActSettings, LeRobotConfig):
    """LeRobot's ACT: a transformer that plans chunks of actions (Zhao et al. 2023)."""

    def design(self, scenes: SceneDescription) -> "Design[LeRobotNetwork]":
        """Return what is trained for some scenes."""
        from prime_policies.lerobot.designs import act

        return act(self, scenes)


class DiffusionConfig(DiffusionSettings, LeRobotConfig):
    """LeRobot's diffusion policy: plans that are made of noise (Chi et al. 2023)."""

    packages: ClassVar[tuple[str, ...]] = ("lerobot", "diffusers")

    def design(self, scenes: SceneDescription) -> "Design[LeRobotNetwork]":
        """Return what is trained for some scenes."""
        from prime_policies.lerobot.designs import diffusion

        return diffusion(self, scenes)

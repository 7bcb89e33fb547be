"""Loads exported models: no environment is built, and each is loaded when it is asked for."""

from functools import cached_property
from pathlib import Path
from typing import Self

from prime_core.configuration import Config, ConfigDump
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.parser import ParserConfig
from prime_core.contracts.perception import Perception, PerceptionConfig
from prime_core.contracts.policy import MotorPolicy, MotorPolicyConfig, PolicyConfig
from prime_core.contracts.primitive import Primitive, PrimitiveConfig
from prime_core.contracts.training import ModelContext, TrainableConfig
from prime_core.deployment.acting import acting_policy
from prime_core.deployment.manifest import MODELS, Manifest, mistake_in, read_manifest
from prime_core.errors import ConfigurationError
from prime_core.execution.world import primitive_space
from prime_core.learning.perceived import PerceivedIdm
from prime_core.registry.fields import read_settings

TRAINED = "trained"
"""Key of the settings of learned primitives that names the folder of what was trained."""

NO_PRIMITIVES = PrimitiveSpace((), ())
"""What policies over motor actions and perceptions know of primitives."""


class ExportedModels:
    """The models in a folder that ``prime export-policy`` wrote.

    Loading needs the packs that register the models' types. Networks need torch. Scripted
    primitives, and so policies over them, need mujoco for their inverse kinematics; IDM, parser,
    perception and policies over motor actions do not. No simulator is needed for anything.

    Args:
        folder: The folder.
        manifest: What is in it.
        description: Of the scenes that the models work in.
        device: Where networks compute; see `ModelContext`.

    Attributes:
        folder: The folder.
        manifest: What is in it.
        description: Of the scenes that the models work in.
    """

    def __init__(
        self, folder: Path, manifest: Manifest, description: SceneDescription, device: str = "auto"
    ) -> None:
        self.folder, self.manifest, self.description = folder, manifest, description
        self._device = device

    @classmethod
    def open(cls, folder: Path | str, device: str = "auto") -> Self:
        """Open a folder; nothing but its description is read yet.

        Raises:
            ConfigurationError: If it is no folder of exported models.
            DamagedError: If what describes it is not what was written.
        """
        place = Path(folder)
        return cls(place, *read_manifest(place), device)

    @property
    def space(self) -> PrimitiveSpace:
        """The primitives' names and parameters."""
        return self.manifest.space

    def primitives(self) -> tuple[Primitive, ...]:
        """Build the primitives, in the order of the space.

        Raises:
            ConfigurationError: If what is installed makes other primitives than those exported.
            PrimeError: If one cannot be built.
        """
        built = tuple(
            self._settings(PrimitiveConfig, self._placed(dump), "primitives").build(
                self.description
            )
            for dump in self.manifest.primitives
        )
        if primitive_space(built) != self.space:
            raise ConfigurationError(
                f"{self.folder / MODELS}: the primitives that are installed have other names or "
                f"parameters than those that were exported: install {self._versions}"
            )
        return built

    @cached_property
    def perception(self) -> Perception | None:
        """What tells object poses from images; None where the models are given them."""
        model = self.manifest.perception
        if model is None:
            return None
        config = self._settings(PerceptionConfig, model.settings, "perception")
        return config.load(self.folder / model.weights, self._context(config, NO_PRIMITIVES))

    def policy(self) -> MotorPolicy:
        """Load the policy as something that acts; one over primitives with its runner.

        Raises:
            PrimeError: If it cannot be loaded; the text says what is missing.
        """
        model = self.manifest.policy
        config = self._settings(PolicyConfig, model.settings, "policy")
        is_motor = isinstance(config, MotorPolicyConfig)
        return acting_policy(
            config,
            self.folder / model.weights,
            self._context(config, NO_PRIMITIVES if is_motor else self.space),
            self.perception if model.perceived else None,
            () if is_motor else self.primitives(),
            self.manifest.runner,
        )

    def idm(self) -> InverseDynamicsModel:
        """Load the inverse dynamics model, seen through the perception where the run's was.

        Raises:
            ConfigurationError: If none was exported.
            PrimeError: If it cannot be loaded.
        """
        model = self.manifest.idm
        if model is None:
            raise ConfigurationError(
                f"{self.folder}: holds no IDM: run {self.manifest.origin.run!r} had not trained "
                "one when its policy was exported"
            )
        config = self._settings(IdmConfig, model.settings, "idm")
        idm = config.load(self.folder / model.weights, self._context(config, self.space))
        perception = self.perception if model.perceived else None
        return idm if perception is None else PerceivedIdm(perception, idm)

    def parser(self) -> ParserConfig:
        """Return the settings of the run's parser."""
        return self._settings(ParserConfig, self.manifest.parser, "parser")

    def _context(self, config: TrainableConfig, space: PrimitiveSpace) -> ModelContext:
        cameras = self.manifest.cameras if "images" in config.modalities else None
        return ModelContext(
            description=self.description, space=space, device=self._device, cameras=cameras
        )

    def _placed(self, dump: ConfigDump) -> ConfigDump:
        """Return a primitive's settings with the place of what was trained."""
        trained = dump.get(TRAINED)
        return dump if trained is None else {**dump, TRAINED: str(self.folder / trained)}

    def _settings[AnyConfig: Config](
        self, base: type[AnyConfig], dump: ConfigDump, key: str
    ) -> AnyConfig:
        try:
            return read_settings(base, dump)
        except ValueError as error:
            raise ConfigurationError(
                f"{self.folder / MODELS}: {key}: {mistake_in(error)}. It was exported with "
                f"{self._versions}"
            ) from error

    @property
    def _versions(self) -> str:
        found = self.manifest.origin.versions.items()
        return ", ".join(f"{name} {version}" for name, version in found if "prime-" in name)

"""An environment and the primitives that can be run in it."""

from collections.abc import Sequence
from dataclasses import dataclass

from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import Environment
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.training import ModelContext
from prime_core.errors import ConfigurationError


@dataclass(frozen=True, eq=False)
class World:
    """An environment and the primitives that can be run in it."""

    environment: Environment
    primitives: tuple[Primitive, ...]

    @property
    def description(self) -> SceneDescription:
        """Of the environment's scenes."""
        return self.environment.description

    @property
    def space(self) -> PrimitiveSpace:
        """The primitives' names and parameters."""
        return primitive_space(self.primitives)

    def context(self, device: str, cameras: CameraConfig | None = None) -> ModelContext:
        """Return where models are used that compute on a device, and see through cameras."""
        return ModelContext(
            description=self.description, space=self.space, device=device, cameras=cameras
        )


def primitive_space(primitives: Sequence[Primitive]) -> PrimitiveSpace:
    """Return the names and parameters of primitives.

    Raises:
        ConfigurationError: If two have the same name.
    """
    names = tuple(item.name for item in primitives)
    check_names(names)
    return PrimitiveSpace(names, tuple(item.parameter_space for item in primitives))


def check_names(names: Sequence[str]) -> None:
    """Make sure that primitives are told apart by their names.

    Raises:
        ConfigurationError: If two have the same name.
    """
    for name in names:
        if names.count(name) > 1:
            raise ConfigurationError(
                f"primitives: two of them are named {name!r}: leave one out, or give a learned one "
                "another name"
            )

"""The hooks that a plugin may implement (entry-point group ``prime``).

Each is given a callback ``register(name, config_class)``.
"""

from collections.abc import Callable
from typing import Any

import pluggy

GROUP = "prime"


hookspec = pluggy.HookspecMarker(GROUP)


hookimpl = pluggy.HookimplMarker(GROUP)


Register = Callable[[str, type[Any]], None]


@hookspec
def register_environments(register: Register) -> None:
    """Register environments: subclasses of `EnvironmentConfig`."""


@hookspec
def register_primitives(register: Register) -> None:
    """Register primitives: subclasses of `PrimitiveConfig`."""


@hookspec
def register_demonstrators(register: Register) -> None:
    """Register sources of demonstrations: subclasses of `DemonstratorConfig`."""


@hookspec
def register_idms(register: Register) -> None:
    """Register inverse dynamics models: subclasses of `IdmConfig`."""


@hookspec
def register_parsers(register: Register) -> None:
    """Register parsers: subclasses of `ParserConfig`."""


@hookspec
def register_policies(register: Register) -> None:
    """Register policies: subclasses of `PolicyConfig`."""


@hookspec
def register_perceptions(register: Register) -> None:
    """Register what tells object poses from images: subclasses of `PerceptionConfig`."""


@hookspec
def register_encoders(register: Register) -> None:
    """Register encoders of images: subclasses of `EncoderConfig`."""


@hookspec
def register_exporters(register: Register) -> None:
    """Register formats that demonstrations are written in: subclasses of `ExporterConfig`."""


@hookspec
def register_commands(register: Callable[[str, Callable[..., Any]], None]) -> None:
    """Register commands: functions that typer makes subcommands of ``prime``."""

"""What lies in a folder of exported models, as plain data: ``models.json`` and ``scene.json``."""

import json
from pathlib import Path
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from prime_core.configuration import Config, ConfigDump
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.images import CameraConfig
from prime_core.errors import ConfigurationError, DamagedError
from prime_core.execution.settings import RunnerConfig

MODELS, SCENE = "models.json", "scene.json"


class Origin(Config):
    """Where exported models came from."""

    run: str
    """Name of the experiment."""
    policy: str
    """Name of the policy in it."""
    seed: int
    """Of the policy's training."""
    checkpoint: int
    """Number of the checkpoint, the oldest is 0."""
    environment: ConfigDump
    """Settings of the environment that the policy was trained for; nothing is built from them."""
    maximum_steps: int
    """Motor actions of a trial at most, in the run's evaluation."""
    commit: str | None
    """Of the checkout that exported; None where prime was installed from a wheel."""
    versions: dict[str, str]
    """Of Python, prime's distributions and what they stand on."""


class ExportedModel(Config):
    """A model: what it is and where its weights are."""

    settings: ConfigDump
    """With their ``type``, defaults written out."""
    weights: str
    """Within the folder."""
    perceived: bool = False
    """Whether the perception tells it object poses."""


class Manifest(Config):
    """What ``models.json`` holds."""

    format: Literal[1] = 1
    origin: Origin
    rate: int
    """Motor actions a second [Hz]."""
    primitives: tuple[ConfigDump, ...]
    """Settings of the primitives; ``trained`` is within the folder."""
    space: PrimitiveSpace
    """The primitives' names and parameters, in the order of ``primitives``."""
    cameras: CameraConfig | None
    """What models that see images see through; None where none does."""
    runner: RunnerConfig
    """How calls of primitives are run; means nothing to a policy over motor actions."""
    policy: ExportedModel
    perception: ExportedModel | None
    idm: ExportedModel | None
    """None where the run had not trained it."""
    parser: ConfigDump
    """Settings."""


_SCENE: TypeAdapter[SceneDescription] = TypeAdapter(SceneDescription)


def write_manifest(folder: Path, manifest: Manifest, description: SceneDescription) -> None:
    """Write both files."""
    parts = {MODELS: manifest.model_dump(mode="json"), SCENE: _SCENE.dump_python(description)}
    for name, data in parts.items():
        (folder / name).write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")


def read_manifest(folder: Path) -> tuple[Manifest, SceneDescription]:
    """Read both files.

    Raises:
        ConfigurationError: If there are none.
        DamagedError: If they are not what was written.
    """
    if not (folder / MODELS).is_file():
        raise ConfigurationError(
            f"{folder}: there is no {MODELS} in it: name a folder that 'prime export-policy' wrote"
        )
    return _read(folder / MODELS, TypeAdapter(Manifest)), _read(folder / SCENE, _SCENE)


def _read[Read](path: Path, adapter: TypeAdapter[Read]) -> Read:
    try:
        data: Any = json.loads(path.read_text(encoding="utf-8"))
        return adapter.validate_python(data)
    except FileNotFoundError:
        raise DamagedError(f"{path} is missing: export the policy again") from None
    except (ValueError, RecursionError) as error:  # no JSON, no text, or other keys
        reason = mistake_in(error)
    raise DamagedError(
        f"{path} is not what this version's 'prime export-policy' writes: {reason}. Export the "
        "policy again"
    )


def mistake_in(error: Exception) -> str:
    """Return what is wrong with plain data, in a line: of several mistakes the first."""
    if not isinstance(error, ValidationError):
        return str(error)
    first = error.errors()[0]
    key, text = ".".join(map(str, first["loc"])), first["msg"].removeprefix("Value error, ")
    return f"{key}: {text}" if key else text

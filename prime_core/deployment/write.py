"""Writes a folder of exported models: whole, or not at all."""

import shutil
from collections.abc import Mapping
from pathlib import Path

from prime_core.contracts.description import SceneDescription
from prime_core.deployment.manifest import Manifest, write_manifest
from prime_core.errors import ConfigurationError
from prime_core.files import new_folder


def write_models(
    target: Path, manifest: Manifest, description: SceneDescription, weights: Mapping[str, Path]
) -> None:
    """Write a folder that holds all that its models need.

    Args:
        target: The folder; it must not exist.
        manifest: What is in it.
        description: Of the scenes that the models work in.
        weights: By where they go within the folder, where they are: files or folders.

    Raises:
        ConfigurationError: If the target is there already.
    """
    check_is_new(target)
    with new_folder(target) as partial:
        for name, source in weights.items():
            place = partial / name
            place.parent.mkdir(parents=True, exist_ok=True)
            if source.is_dir():
                shutil.copytree(source, place, copy_function=shutil.copyfile)
            else:
                shutil.copyfile(source, place)
        write_manifest(partial, manifest, description)


def check_is_new(target: Path) -> None:
    """Make sure that nothing is where a folder is to be written.

    Raises:
        ConfigurationError: If something is.
    """
    if target.exists() or target.is_symlink():
        raise ConfigurationError(
            f"{target}: is there already: choose another folder with --out, or remove it"
        )

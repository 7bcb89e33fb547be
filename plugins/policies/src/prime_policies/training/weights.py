"""What is kept of a training: weights as safetensors, and a card, YAML, of what they are for.

Nothing is unpickled. Every file is written aside and renamed, so that none is ever half there.
"""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
import yaml
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor, nn

from prime_core.contracts.training import ModelContext
from prime_core.errors import PrimeError
from prime_core.files import new_file

CARD = "model.yaml"
NOTES, CHECKSUM = "notes", "checksum"
FORMAT = 3  # of the weights; rises with a change that makes older ones mean something else

Card = dict[str, Any]


class WeightsError(PrimeError):
    """A folder does not hold the weights that are asked for."""


def make_card(kind: str, settings: Card, context: ModelContext) -> Card:
    """Return what weights are for, as plain data.

    Args:
        kind: Name that the settings are registered under.
        settings: Their dump.
        context: The scenes that the networks see, and the primitives that they know.
    """
    space, objects = context.space, context.description.objects
    return {
        "kind": kind,
        "format": FORMAT,
        "settings": settings,
        # Their order is part of what the weights mean.
        "object_order": [item.name for item in objects],
        "objects": {item.name: {"yaw_symmetry": item.yaw_symmetry} for item in objects},
        "primitive_order": list(space.names),
        "primitives": {
            name: {item.name: {"unit": item.unit, "period": item.period} for item in own.parameters}
            for name, own in zip(space.names, space.parameter_spaces, strict=True)
        },
    }


def write_card(folder: Path, card: Card) -> None:
    """Write a card into a folder."""
    with new_file(folder / CARD) as partial:
        partial.write_text(yaml.safe_dump(card, sort_keys=False), encoding="utf-8")


def check_card(folder: Path, card: Card) -> None:
    """Make sure that a folder's card is the one expected.

    Raises:
        WeightsError: If there is none, or if it is another one.
    """
    path = folder / CARD
    if not path.is_file():
        raise WeightsError(
            f"{folder} holds no trained {card['kind']!r}: {CARD} is missing. Either the training "
            "has not finished, or this is not a folder that a training wrote."
        )
    try:
        found = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise WeightsError(f"{path} is not readable YAML: {error}") from error
    differences = list(_differences(found, card))
    if differences:
        raise WeightsError(f"{path} is of another model than asked for: {'; '.join(differences)}")


def _differences(found: Any, expected: Any, key: str = "") -> list[str]:
    """Return one sentence for each key with another value."""
    if not (isinstance(found, dict) and isinstance(expected, dict)):
        return [] if found == expected else [f"{key or 'it'} is {found!r} there, {expected!r} here"]
    result = []
    for name in dict.fromkeys((*expected, *found)):
        here = f"{key}.{name}" if key else str(name)
        if name not in found:
            result.append(f"{here} is missing there")
        elif name not in expected:
            result.append(f"{here} is only there")
        else:
            result += _differences(found[name], expected[name], here)
    return result


def write_tensors(path: Path, tensors: Mapping[str, Tensor], notes: Mapping[str, str]) -> None:
    """Write tensors, with notes and a checksum as the file's metadata."""
    owned = {name: tensor.detach().contiguous() for name, tensor in tensors.items()}
    with new_file(path) as partial:
        # In one text: safetensors writes several in any order, and files are to be the same.
        save_file(owned, partial, {NOTES: json.dumps({**notes, CHECKSUM: _checksum(owned)})})


def read_tensors(path: Path) -> tuple[dict[str, Tensor], dict[str, str]]:
    """Read tensors and notes.

    Raises:
        WeightsError: If the file is missing, no safetensors file, or not what was written.
    """
    if not path.is_file():
        raise WeightsError(f"{path} is missing: the folder is incomplete; train again")
    try:
        with safe_open(path, framework="pt") as file:
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
            metadata = dict(file.metadata() or {})
        if NOTES not in metadata:
            return tensors, metadata  # an earlier version wrote no checksum
        notes = dict(json.loads(metadata[NOTES]))
    except (SafetensorError, ValueError) as error:
        raise WeightsError(f"{path} is no safetensors file: {error}") from error
    if notes.pop(CHECKSUM, None) != _checksum(tensors):
        raise WeightsError(f"{path} is damaged: remove {path.parent} to train anew")
    return tensors, notes


def _checksum(tensors: Mapping[str, Tensor]) -> str:
    total = hashlib.sha256()
    for name in sorted(tensors):
        tensor = tensors[name]
        total.update(f"{name} {tensor.dtype} {tuple(tensor.shape)}".encode())
        total.update(tensor.cpu().reshape(-1).view(torch.uint8).numpy().tobytes())
    return total.hexdigest()[:16]


def load_weights(network: nn.Module, path: Path) -> None:
    """Load a network's weights from a file.

    Raises:
        WeightsError: If the file is missing, or holds another network's weights.
    """
    tensors, _ = read_tensors(path)
    try:
        network.load_state_dict(tensors)
    except RuntimeError as error:
        raise WeightsError(f"{path} holds the weights of another network: {error}") from error

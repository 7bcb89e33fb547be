"""The card of a model: what its weights are for, as plain data, kept as YAML beside them."""

import hashlib
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from prime_core.contracts.observations import Observations
from prime_core.contracts.training import CallData, ModelContext
from prime_core.errors import WeightsError
from prime_core.files import new_file

CARD = "model.yaml"

Card = dict[str, Any]


def make_card(kind: str, version: int, settings: Card, context: ModelContext) -> Card:
    """Return what weights are for, as plain data.

    Args:
        kind: Name that the settings are registered under.
        version: Of the weights; rises with a change that makes older ones mean something else.
        settings: Their dump.
        context: The scenes that the networks see, and the primitives that they know.
    """
    space, objects = context.space, context.description.objects
    return {
        "kind": kind,
        "format": version,
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
    """Write a card into a folder, which is made if need be."""
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
    differences = _differences(found, card)
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


def fingerprint(card: Card, seed: int, data: Sequence[CallData | Observations]) -> str:
    """Return what tells a training apart: its card, its seed and its data, but for images."""
    digest = hashlib.blake2b(json.dumps([card, seed]).encode(), digest_size=16)
    for array in (array for item in data for array in _arrays(item)):
        if array is not None:
            digest.update(repr((array.shape, array.dtype)).encode())
            digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()


def _arrays(data: CallData | Observations) -> Iterator[NDArray[Any] | None]:
    if isinstance(data, Observations):
        yield from (data.state, data.environment_state)
        return
    yield from _arrays(data.observations)
    for labels in (data.types, data.parameters):
        yield from vars(labels).values()
    yield from (data.values, data.under_way)

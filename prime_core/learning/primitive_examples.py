"""What primitives are learnt from: the segments of a parsed data set."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from prime_core.contracts.calls import OTHER
from prime_core.contracts.demonstration import Demonstration, Segment
from prime_core.contracts.primitive import PrimitiveExamples
from prime_core.datasets.read import read_dataset
from prime_core.errors import DatasetError


def primitive_examples(folder: Path) -> dict[str, PrimitiveExamples]:
    """Read the segments of a data set, by what they call the primitive, the most frequent first.

    Args:
        folder: Of a LeRobot data set with prime's segments.

    Raises:
        DatasetError: If it is broken, or not parsed.
    """
    dataset = read_dataset(folder)
    if dataset.segments is None or dataset.space is None:
        raise DatasetError(
            f"{folder} has no segments: name a data set that was parsed, such as the folder "
            "'dataset' of a run, or parse it with 'prime parse'"
        )
    found: dict[str, list[tuple[Demonstration, Segment]]] = {}
    for demonstration, segments in zip(dataset.demonstrations, dataset.segments, strict=True):
        for segment in segments:
            if segment.call.primitive != OTHER:
                found.setdefault(segment.call.primitive, []).append((demonstration, segment))
    spaces = dict(zip(dataset.space.names, dataset.space.parameter_spaces, strict=True))
    return {
        name: PrimitiveExamples(
            name=name,
            space=spaces[name],
            executions=tuple(_frames(*pair) for pair in pairs),
            parameters=np.array([segment.call.parameters for _, segment in pairs]),
        )
        for name, pairs in sorted(found.items(), key=lambda item: -len(item[1]))
    }


def examples_of(
    name: str, found: Mapping[str, PrimitiveExamples], folder: Path
) -> PrimitiveExamples:
    """Return the segments of one primitive.

    Args:
        name: What they call it.
        found: From `primitive_examples`.
        folder: Of the data set.

    Raises:
        DatasetError: If there is none.
    """
    if name not in found:
        counts = [f"{other} ({len(item.executions)})" for other, item in found.items()]
        text = ", ".join(counts) or "none at all"
        raise DatasetError(f"{folder} has no segment of {name!r}; it has {text}")
    return found[name]


def _frames(demonstration: Demonstration, segment: Segment) -> Demonstration:
    rows = slice(segment.start, segment.end + 1)
    return Demonstration(
        demonstration.observations[rows], demonstration.actions[rows], demonstration.task
    )

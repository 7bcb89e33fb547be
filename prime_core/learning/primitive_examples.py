"""What primitives are learnt from: the segments of a parsed data set."""

from collections import Counter
from pathlib import Path

import numpy as np

from prime_core.contracts.calls import OTHER, PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration, Segment
from prime_core.contracts.primitive import PrimitiveExamples
from prime_core.datasets.read import Dataset, read_dataset
from prime_core.errors import DatasetError


def segment_counts(folder: Path) -> dict[str, int]:
    """Return how many segments of each primitive a data set has, the most frequent first.

    Raises:
        DatasetError: If it is broken, or not parsed.
    """
    return dict(_counts(_parsed(folder)))


def primitive_examples(folder: Path, name: str) -> PrimitiveExamples:
    """Read the segments of one primitive.

    Args:
        folder: Of a LeRobot data set with prime's segments.
        name: What they call the primitive.

    Raises:
        DatasetError: If the data set is broken or not parsed, or has no such segment.
    """
    dataset = _parsed(folder)
    counts = _counts(dataset)
    if not counts[name]:
        found = ", ".join(f"{other} ({count})" for other, count in counts.most_common())
        raise DatasetError(f"{folder} has no segment of {name!r}; it has {found or 'none at all'}")
    assert dataset.segments is not None, "it is parsed"
    pairs = [
        (demonstration, segment)
        for demonstration, segments in zip(dataset.demonstrations, dataset.segments, strict=True)
        for segment in segments
        if segment.call.primitive == name
    ]
    space: PrimitiveSpace | None = dataset.space
    assert space is not None, "it is parsed"
    return PrimitiveExamples(
        name=name,
        space=space.parameter_spaces[space.names.index(name)],
        executions=tuple(_frames(*pair) for pair in pairs),
        parameters=np.array([segment.call.parameters for _, segment in pairs]),
    )


def _parsed(folder: Path) -> Dataset:
    dataset = read_dataset(folder)
    if dataset.segments is None:
        raise DatasetError(
            f"{folder} has no segments: name a data set that was parsed, such as the folder "
            "'dataset' of a run, or parse it with 'prime parse'"
        )
    return dataset


def _counts(dataset: Dataset) -> Counter[str]:
    names = (segment.call.primitive for segments in dataset.segments or () for segment in segments)
    return Counter(name for name in names if name != OTHER)


def _frames(demonstration: Demonstration, segment: Segment) -> Demonstration:
    rows = slice(segment.start, segment.end + 1)
    return Demonstration(
        demonstration.observations[rows], demonstration.actions[rows], demonstration.task
    )

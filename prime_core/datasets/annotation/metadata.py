"""Segments in the metadata: our table of them, the features, and the statistics of the labels."""

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.calls import PrimitiveSpace
from prime_core.datasets.columns.settings import ColumnsConfig
from prime_core.datasets.files import layout
from prime_core.datasets.files.header import Header, read_json
from prime_core.datasets.files.metadata_writer import write_json, write_table
from prime_core.datasets.files.parquet_reader import whole_numbers, whole_table, with_column
from prime_core.datasets.files.statistics import Statistics, merge, plain, statistics_of
from prime_core.datasets.read import read_prime_file
from prime_core.datasets.segments import dump_space

STATISTICS_PREFIX = "stats/"


def annotate_metadata(
    header: Header,
    target: Path,
    episode_files: Sequence[tuple[Path, Path]],
    labels: Mapping[int, NDArray[np.int64]],
    segments: Any,
    space: PrimitiveSpace,
    columns: ColumnsConfig | None,
) -> None:
    """Write the metadata of an annotated data set.

    Args:
        header: Of the data set.
        target: Folder of the annotated one.
        episode_files: The files of ``meta/episodes``, and where the new ones go.
        labels: The class of each frame, of each episode.
        segments: Our table of them.
        space: Their primitives.
        columns: By which mapping the data set was read.
    """
    info = dict(header.info)
    own = layout.segment_features()
    info["features"] = {**info["features"], **own}
    write_json(target / layout.INFO_FILE, info)
    statistics = {index: statistics_of(items) for index, items in labels.items()}
    totals = header.folder / layout.STATISTICS_FILE
    if totals.is_file():
        whole = plain(merge([*statistics.values()]))
        write_json(
            target / layout.STATISTICS_FILE,
            {**read_json(totals), layout.PRIMITIVE_INDEX_KEY: whole},
        )
    for source, place in episode_files:
        _annotate_episodes(source, place, statistics)
    write_table(target / layout.PRIMITIVES_FILE, segments)
    content = {"version": 1, "environment": None, **read_prime_file(header.folder)}
    content["primitives"] = dump_space(space)
    if columns is not None:
        content["columns"] = columns.model_dump(mode="json")
    write_json(target / layout.PRIME_FILE, content)


def _annotate_episodes(source: Path, target: Path, statistics: Mapping[int, Statistics]) -> None:
    """Write a file of ``meta/episodes`` with the statistics of its episodes' labels.

    One without any statistics stays as it is.
    """
    table = whole_table(source)
    if not any(name.startswith(STATISTICS_PREFIX) for name in table.column_names):
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, target)
        return
    chosen = whole_numbers(source, table, "episode_index").tolist()
    listed = [plain(statistics[index]) for index in chosen]
    for name in listed[0]:
        key = f"{STATISTICS_PREFIX}{layout.PRIMITIVE_INDEX_KEY}/{name}"
        table = with_column(table, key, [item[name] for item in listed])
    write_table(target, table)
    shutil.copymode(source, target)

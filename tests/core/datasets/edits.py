"""Changes of a data set's files as other programs and editors make them, and what is said then."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.datasets.read import read_dataset
from prime_core.errors import DatasetError

from .samples import DESCRIPTION

INFO = "meta/info.json"


def edit_info(folder: Path, change: Callable[[dict[str, Any]], object]) -> None:
    info = json.loads((folder / INFO).read_text())
    change(info)
    (folder / INFO).write_text(json.dumps(info))


def edit_column(folder: Path, name: str, key: str, change: Callable[[Any], Any]) -> None:
    """Put another arrow array in the place of a column."""
    path = folder / name
    table = pq.read_table(path, partitioning=None)
    place = table.column_names.index(key)
    column = change(table[key].combine_chunks())
    pq.write_table(table.set_column(place, key, column), path)


def rows(change: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Return a change of a column of vectors that is given and returns an array of rows."""

    def changed(column: Any) -> Any:
        values = np.array(column.to_pylist(), dtype=np.float32)
        kind = pa.list_(pa.float32())
        return pa.array(list(np.asarray(change(values), dtype=np.float32)), kind)

    return changed


def refusal(folder: Path) -> str:
    with pytest.raises(DatasetError) as caught:
        read_dataset(folder, DESCRIPTION)
    text = str(caught.value)
    assert text.startswith(str(folder))
    return text.removeprefix(f"{folder}/")

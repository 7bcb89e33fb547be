"""Changes of parquet files, safetensors and exca's index that leave them readable."""

import json
import random
import shutil
import struct
from pathlib import Path
from typing import Any

import orjson
import pyarrow as pa
import pyarrow.parquet as pq
from changes import change_tree, pickle_bomb


def change_parquet(path: Path, base: Path, draw: random.Random) -> str:
    """Change a parquet file and return in what way; see `hdf5_changes.change_hdf5`."""
    if path.parts[-3] == "data" and draw.random() < 0.08:
        shutil.copy(base / "bombs" / "frames.parquet", path)
        return "bomb"
    table = pq.read_table(path, partitioning=None)
    number = draw.randrange(table.num_columns)
    name, column = table.column_names[number], table.column(number)
    kind = draw.choice(
        ("drop", "rename", "twice", "rows", "rows", "values", "values", "type", "type")
    )
    if kind == "drop":
        table = table.drop_columns([name])
    elif kind == "rename":
        new = draw.choice(
            (name + "2", name.upper(), "", table.column_names[0], "[/red]", "a" * 50_000)
        )
        table = table.rename_columns([new if item == name else item for item in table.column_names])
    elif kind == "twice":
        table = table.append_column(name, column)
    elif kind == "rows":
        table = _change_rows(table, draw)
    elif kind == "values":
        table = table.set_column(number, name, _change_values(column, draw))
    else:
        table = table.set_column(number, name, _another_type(column, draw))
    try:
        pq.write_table(table, path)
    except (pa.ArrowException, ValueError):  # what parquet does not have
        path.write_bytes(path.read_bytes()[:-8])
        kind = "cut"
    return f"{kind} {name[:40]}"


def _change_rows(table: Any, draw: random.Random) -> Any:
    rows = [*range(len(table))]
    draw.shuffle(rows)
    return draw.choice(
        (
            table.slice(0, 0),
            table.slice(0, 1),
            table.slice(1),
            table.slice(0, max(len(table) - 1, 0)),
            pa.concat_tables([table, table]),
            table.take(rows),
        )
    )


def _change_values(column: Any, draw: random.Random) -> Any:
    values = column.to_pylist()
    for _ in range(draw.choice((1, 1, 5))):
        row = draw.randrange(len(values)) if values else 0
        if values:
            values[row] = _another(values[row], draw)
    try:
        return pa.array(values, column.type)
    except (pa.ArrowException, OverflowError, TypeError, ValueError):
        return pa.nulls(len(values), column.type)


def _another(value: Any, draw: random.Random) -> Any:
    if isinstance(value, list) and value and draw.random() < 0.7:
        place = draw.randrange(len(value))
        return [*value[:place], _another(value[place], draw), *value[place + 1 :]]
    if isinstance(value, list):
        return draw.choice(([], value * 2, value[:-1], None))
    if isinstance(value, str):
        return draw.choice(("", None, "a" * 1_000_000, "\x00", "[/red]", "../..", "\U0001f600"))
    numbers = (None, -1, 0, 10**9, 2**62, -(2**63), 1e300, float("nan"), float("inf"))
    return draw.choice(numbers if isinstance(value, float) else numbers[:6])


def _another_type(column: Any, draw: random.Random) -> Any:
    count = len(column)
    dictionary = pa.array(["a"] * count).dictionary_encode()
    return draw.choice(
        (
            pa.array([str(value) for value in column.to_pylist()]),
            pa.array([1.5] * count, pa.float32()),
            pa.array([1] * count, pa.uint64()),
            pa.array([[1.0]] * count),
            pa.array([[[1.0]]] * count),
            pa.array([{"a": 1}] * count),
            pa.nulls(count),
            pa.array([pickle_bomb()] * count),
            pa.array([True] * count),
            pa.array([0] * count, pa.timestamp("us")),
            pa.array([0] * count, pa.decimal128(30, 2)),
            dictionary,
        )
    )


def change_safetensors(path: Path, base: Path, draw: random.Random) -> str:
    """Change what a safetensors file says of its tensors; see `hdf5_changes.change_hdf5`."""
    data = path.read_bytes()
    (size,) = struct.unpack("<Q", data[:8])
    header, body = data[8 : 8 + size], data[8 + size :]
    if draw.random() < 0.2:
        size = draw.choice((0, 1, size - 1, size + 8, 2**40, 2**64 - 1))
        path.write_bytes(struct.pack("<Q", size) + header + body)
        return "size of the header"
    new = json.dumps(change_tree(json.loads(header), draw)).encode()
    path.write_bytes(struct.pack("<Q", len(new)) + new + body)
    return "header"


def change_index(path: Path, base: Path, draw: random.Random) -> str:
    """Change what exca's index says of an item; see `hdf5_changes.change_hdf5`."""
    (path.parent / "data").mkdir(exist_ok=True)
    (path.parent / "data" / "evil.pkl").write_bytes(pickle_bomb())
    lines = path.read_bytes().splitlines()
    number = draw.randrange(len(lines))
    item = orjson.loads(lines[number])
    kind = draw.choice(("tree", "tree", "type", "pickle", "outside", "twice"))
    if kind == "type":
        types = (
            "NumpyArray",
            "PandasDataFrame",
            "MneRawFif",
            "TorchTensor",
            "Nothing",
            "AutoPickle",
        )
        item = {"#key": item["#key"], "#type": draw.choice(types), "filename": "data/evil.pkl"}
    elif kind in ("pickle", "twice"):
        item = {"#key": item["#key"], "#type": "Pickle", "filename": "data/evil.pkl"}
    elif kind == "outside":  # to be removed when the item is made anew
        steps = "../" * len(path.parent.relative_to(path.parents[5]).parts)
        place = f"{steps}neighbour/precious.txt"
        item = {
            "#key": item["#key"],
            "#type": draw.choice(("Pickle", "NumpyArray")),
            "filename": place,
        }
    else:
        key = item.pop("#key")
        item = change_tree(item, draw)
        item = {"#key": key, **item} if isinstance(item, dict) else item
    if kind == "twice":  # a line of another process
        (path.parent / "zzz-1-info.jsonl").write_bytes(json.dumps(item).encode() + b"\n")
    else:
        lines[number] = json.dumps(item).encode()
        path.write_bytes(b"\n".join(lines) + b"\n")
    return kind

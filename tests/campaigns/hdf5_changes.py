"""Changes of HDF5 files that leave them readable."""

import random
import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from changes import change_json, pickle_bomb


def change_hdf5(path: Path, base: Path, draw: random.Random) -> str:
    """Change an HDF5 file and return in what way.

    Args:
        path: The file.
        base: Folder of the good inputs, where bombs are.
        draw: Of all that is at random.
    """
    if draw.random() < 0.08:
        shutil.copy(base / "bombs" / "states.hdf5", path)
        return "bomb"
    with h5py.File(path, "r+") as file:
        data = file["data"]
        kind = draw.choice(("attribute", "array", "array", "array", "values", "values", "tree"))
        if kind == "attribute":
            return kind + _hdf5_attribute(file, draw)
        if kind == "tree":
            return kind + _hdf5_tree(file, path, draw)
        group = data[draw.choice(list(data))]
        names: list[str] = []
        group.visit(
            lambda name: names.append(name) if isinstance(group[name], h5py.Dataset) else None
        )
        name = draw.choice(names)
        if kind == "values":
            values = group[name][()]
            row = draw.randrange(len(values))
            new = draw.choice((np.nan, np.inf, -np.inf, 1e300, -1e30, 1e-320, 5.0))
            rows = draw.choice((slice(None), row, slice(row, row + 3)))
            values[rows, draw.choice((slice(None), draw.randrange(values.shape[1])))] = new
            group[name][...] = values
            return f"{kind} {name} {new}"
        return f"{kind} {name} {_hdf5_array(group, name, draw)}"


def _hdf5_attribute(file: Any, draw: random.Random) -> str:
    holder = file[draw.choice(("data", "data", "data/demo_1"))]
    present = [*holder.attrs] or ["num_samples"]
    name = draw.choice((*present, "env", "env_args", "env_info", "model_file", "num_samples"))
    old = holder.attrs.get(name)
    if isinstance(old, str) and old.startswith("{") and draw.random() < 0.6:
        holder.attrs[name] = (
            change_json(old.encode(), draw)[:60_000].decode("utf-8", "replace").replace("\x00", "")
        )
        return f" {name} as JSON"
    entity = '<!DOCTYPE a [<!ENTITY a "' + "b" * 50_000 + '">]><mujoco><worldbody>' + "&a;" * 5000
    values = (
        *(
            1,
            -1,
            1.5,
            np.nan,
            "",
            "Lift",
            "Stack",
            "../models/x.xml",
            "[" * 50_000,
            "null",
            b"\xff\xfe",
        ),
        *(np.zeros((3, 3)), h5py.Empty("f8"), np.array([b"a", b"b"]), 10**18, True),
        *(entity + "</worldbody></mujoco>", "<mujoco>" + "<body>" * 5000, "<mujoco/>"),
        *('{"robots": NaN}', '{"control_freq": 1e999}', np.void(pickle_bomb()), "/dev/zero"),
        "<mujoco><worldbody>" + "<body>" * 4000 + "</body>" * 4000 + "</worldbody></mujoco>",
    )
    number = draw.randrange(len(values))
    holder.attrs[name] = values[number]
    return f" {name} number {number}"


def _hdf5_array(group: Any, name: str, draw: random.Random) -> str:
    """Put another array in the place of one."""
    old = group[name][()]
    kind = draw.choice(("dtype", "dtype", "shape", "shape", "huge", "link", "outside", "pickle"))
    del group[name]
    if kind == "dtype":
        dtype = draw.choice(
            ("f2", "f4", "i1", "u8", "c16", "S7", "b1", "text", "reference", "pair")
        )
        if dtype == "text":
            group.create_dataset(name, old.shape, h5py.string_dtype())
        elif dtype == "reference":
            group.create_dataset(name, old.shape, h5py.ref_dtype)
        elif dtype == "pair":
            group.create_dataset(name, old.shape, np.dtype([("a", "f8"), ("b", "i4")]))
        else:
            with np.errstate(all="ignore"):
                group[name] = old.astype(dtype)
        return f"{kind} {dtype}"
    if kind == "shape":
        values = draw.choice(
            (old[:0], old[:1], old[:-1], old[:, :-1], old[:, :0], old.ravel(), old[None], old.T)
        )
        group[name] = values
        return f"{kind} {values.shape}"
    if kind == "huge":
        shape = draw.choice(((10**7, old.shape[1]), (10**12, 7), (2**62, 2), (len(old), 10**9)))
        chunks = tuple(min(part, 100) for part in shape)
        group.create_dataset(name, shape, "f8", chunks=chunks, compression="gzip")
        return f"{kind} {shape}"
    if kind == "link":
        group[name] = draw.choice(
            (
                h5py.SoftLink(name),
                h5py.SoftLink("/"),
                h5py.ExternalLink("../neighbour/other.hdf5", "/x"),
            )
        )
    elif kind == "outside":
        outside = [("../neighbour/precious.txt", 0, old.size * 8)]
        group.create_dataset(name, old.shape, "f8", external=outside)
    else:
        group[name] = np.void(pickle_bomb())
    return kind


def _hdf5_tree(file: Any, path: Path, draw: random.Random) -> str:
    data = file["data"]
    kind = draw.choice(("drop", "rename", "many", "cycle", "empty", "deep"))
    if kind == "drop":
        del file[draw.choice(("data", "data/demo_1", "data/demo_2/actions"))]
    elif kind == "rename":
        data.move(
            "demo_1", draw.choice(("demo", "demo_\u0664", "demo_" + "9" * 5000, "[/red]", "\n"))
        )
    elif kind == "many":
        for number in range(2000):
            data.create_group(f"demo_{number + 10}")
    elif kind == "cycle":
        data["demo_3"] = h5py.SoftLink("/data")
        data["demo_4"] = data
    elif kind == "empty":
        for name in list(data):
            del data[name]
    else:
        data.create_group("/".join(["demo_3", *["a"] * 500]))
    return f" {kind}"

"""What objects collide with, in the XML of a model: read from one, put into another."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import PurePosixPath, PureWindowsPath
from xml.etree import ElementTree

import numpy as np

from prime_core.arrays import Array
from prime_core.rotations import quaternion_product, rotation_matrix

Element = ElementTree.Element
Numbers = tuple[float, ...]

PRECISION = 5  # decimals of a size or a place that count [m]
NOWHERE, UPRIGHT = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class ObjectGeom:
    """The shape of one geom, in the frame of its object.

    Attributes:
        kind: As MuJoCo calls it.
        size: As MuJoCo has it for that kind [m]; of a mesh nothing.
        position: [m].
        quaternion: Its orientation.
        mesh: Name of the mesh's file without its ending; None where it is none.
        scale: Of the mesh along its axes.
    """

    kind: str
    size: Numbers
    position: Numbers
    quaternion: Numbers
    mesh: str | None = None
    scale: Numbers = (1.0, 1.0, 1.0)


Geoms = Mapping[str, tuple[ObjectGeom, ...]]
"""The geoms of objects by the names of their bodies."""


def only_shows(geom: Element) -> bool:
    """Whether a geom collides with nothing."""
    return geom.get("contype") == "0" and geom.get("conaffinity") == "0"


def read_geoms(root: Element, body: Element) -> tuple[ObjectGeom, ...]:
    """Return what an object collides with.

    Args:
        root: Of the model.
        body: Of the object; what hangs on it belongs to it.

    Raises:
        ValueError: If a number is none.
    """
    meshes = {mesh.get("name", _stem(mesh)): mesh for mesh in root.iterfind("asset/mesh")}
    return tuple(_read(body, meshes, np.zeros(3), np.array(UPRIGHT)))


def _read(
    body: Element, meshes: Mapping[str, Element], at: Array, turned: Array
) -> list[ObjectGeom]:
    found = []
    for geom in body.findall("geom"):
        if only_shows(geom):
            continue
        position = at + rotation_matrix(turned) @ _numbers(geom, "pos", NOWHERE)
        quaternion = quaternion_product(turned, _numbers(geom, "quat", UPRIGHT))
        mesh = meshes.get(geom.get("mesh", ""))
        scale = (1.0, 1.0, 1.0) if mesh is None else _rounded(_numbers(mesh, "scale", (1.0,) * 3))
        found.append(
            ObjectGeom(
                kind=geom.get("type", "sphere"),
                size=() if mesh is not None else _rounded(_numbers(geom, "size", ())),
                position=_rounded(position),
                quaternion=_rounded(quaternion),
                mesh=None if mesh is None else _stem(mesh),
                scale=scale,
            )
        )
    for child in body.findall("body"):
        inner = at + rotation_matrix(turned) @ _numbers(child, "pos", NOWHERE)
        found += _read(
            child, meshes, inner, quaternion_product(turned, _numbers(child, "quat", UPRIGHT))
        )
    return found


def put_geoms(root: Element, geoms: Geoms) -> None:
    """Give objects other geoms, in place; all but their shapes stays as it is.

    An object keeps its own where a mesh is wanted that is not among its own.

    Args:
        root: Of a model.
        geoms: The new geoms of some objects.
    """
    assets = root.find("asset")
    for name, wanted in geoms.items():
        body = root.find(f".//body[@name='{name}']")
        if body is None or assets is None:
            continue
        own = [(parent, geom) for parent in body.iter("body") for geom in parent.findall("geom")]
        own = [(parent, geom) for parent, geom in own if not only_shows(geom)]
        used = {geom.get("mesh") for _, geom in own}
        meshes = {_stem(mesh): mesh for mesh in assets.iter("mesh") if mesh.get("name") in used}
        if not own or not {geom.mesh for geom in wanted} <= {None, *meshes}:
            continue
        for parent, geom in own:
            parent.remove(geom)
        for number, geom in enumerate(wanted):
            pattern = own[min(number, len(own) - 1)][1]
            added = deepcopy(pattern)
            added.set("name", f"{name}_{number}" if number >= len(own) else added.get("name", name))
            _shape(added, geom)
            if geom.mesh is not None:
                mesh = deepcopy(meshes[geom.mesh])
                mesh.set("name", f"{name}_mesh_{number}")
                mesh.set("scale", _text(geom.scale))
                assets.append(mesh)
                added.set("mesh", f"{name}_mesh_{number}")
            body.append(added)


def _shape(element: Element, geom: ObjectGeom) -> None:
    """Write a geom's shape into an element."""
    for key in ("size", "mesh", "euler", "axisangle", "fromto"):
        element.attrib.pop(key, None)
    element.set("type", geom.kind)
    element.set("pos", _text(geom.position))
    element.set("quat", _text(geom.quaternion))
    if geom.size:
        element.set("size", _text(geom.size))


def _stem(mesh: Element) -> str:
    """Return the name of a mesh's file without folders, of any system, and ending."""
    return PurePosixPath(PureWindowsPath(mesh.get("file", "")).name).stem


def _numbers(element: Element, key: str, default: Sequence[float]) -> Array:
    text = element.get(key)
    return np.array(default if text is None else [float(item) for item in text.split()])


def _rounded(values: Array) -> Numbers:
    # Adding nothing turns -0 into 0.
    return tuple(round(float(value), PRECISION) + 0.0 for value in values)


def _text(numbers: Sequence[float]) -> str:
    return " ".join(map(repr, numbers))

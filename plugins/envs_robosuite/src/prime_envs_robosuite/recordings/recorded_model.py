"""The MuJoCo model that a recording was made with: its joints, and the shapes of its objects."""

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from prime_core.errors import DemonstrationError
from prime_envs_robosuite.recordings.hdf5_file import text_of
from prime_envs_robosuite.simulation.object_geoms import ObjectGeom, read_geoms

ARM, FINGERS = 7, 2
WIDTHS = {"free": (7, 6), "ball": (4, 3)}  # of a joint in qpos and qvel; of all others 1


class RecordedModel:
    """A model in MuJoCo's XML, as robosuite's recorders keep it.

    Args:
        where: File and group of the demonstration, for errors.
        root: Of the XML.

    Raises:
        DemonstrationError: If it has no world.
    """

    def __init__(self, where: str, root: ElementTree.Element) -> None:
        self._where = where
        self._root = root
        world = root.find("worldbody")
        if world is None:
            raise DemonstrationError(f"{where}: its model_file has no worldbody: no MuJoCo model")
        self._joints = list(_joints(world))

    @classmethod
    def read(cls, where: str, path: Path, group: Any) -> "RecordedModel | None":
        """Return the model of a demonstration, None where the recording has none.

        Args:
            where: File and group, for errors.
            path: Of the file; models may lie beside it.
            group: Of the demonstration.

        Raises:
            DemonstrationError: If what it has is no model.
        """
        text = text_of(where, group, "model_file")
        if text is None:
            return None
        try:
            if not text.lstrip().startswith("<"):  # robosuite 1.0 kept models in their own files
                text = (path.parent / "models" / Path(text).name).read_text(encoding="utf-8")
            return cls(where, ElementTree.fromstring(text))
        except OSError:
            return None
        except (ElementTree.ParseError, ValueError) as error:
            raise DemonstrationError(f"{where}: its model_file is no XML: {error}") from None

    @property
    def widths(self) -> list[tuple[int, int]]:
        """Widths in qpos and qvel of all joints, in their order."""
        return [WIDTHS.get(_kind(joint), (1, 1)) for _, joint in self._joints]

    def find(self, objects: Sequence[str]) -> list[int]:
        """Return which joints are a Panda's, its fingers' and some objects', in this order.

        Raises:
            DemonstrationError: If one of them is not there.
        """
        patterns = [rf"robot0_joint{number}" for number in range(1, ARM + 1)]
        patterns += [rf"gripper0_(right_)?finger_joint{n}" for n in range(1, FINGERS + 1)]
        patterns += map(_pattern, objects)
        names = [joint.get("name", "") for _, joint in self._joints]
        found = []
        for pattern in patterns:
            hits = [k for k, name in enumerate(names) if re.fullmatch(pattern, name, re.IGNORECASE)]
            if len(hits) != 1:
                wanted = " and ".join(map(repr, objects))
                raise DemonstrationError(
                    f"{self._where}: its model_file has the joints {', '.join(names)}; wanted are "
                    f"those of a Panda, of its two fingers and of {wanted} (robosuite's names)"
                )
            found += hits
        return found

    def geoms(self, name: str) -> tuple[ObjectGeom, ...]:
        """Return what an object collides with.

        Args:
            name: robosuite's name of the object.

        Raises:
            DemonstrationError: If its numbers are none.
        """
        for body, joint in self._joints:
            if re.fullmatch(_pattern(name), joint.get("name", ""), re.IGNORECASE):
                try:
                    return read_geoms(self._root, body)
                except ValueError as error:
                    raise DemonstrationError(
                        f"{self._where}: its model_file has a strange geom of {name!r}: {error}"
                    ) from None
        return ()


def _pattern(name: str) -> str:
    """Return what matches the joint of an object; 1.0 numbered some objects, and said jnt."""
    return rf"{re.escape(name)}0?_(joint|jnt)0"


def _joints(
    body: ElementTree.Element,
) -> Iterator[tuple[ElementTree.Element, ElementTree.Element]]:
    """Yield all joints, each after its body, in MuJoCo's order."""
    for joint in body:
        if joint.tag in ("joint", "freejoint"):
            yield body, joint
    for child in body.findall("body"):
        yield from _joints(child)


def _kind(joint: ElementTree.Element) -> str:
    return "free" if joint.tag == "freejoint" else joint.get("type", "hinge")

"""The robosuite environment of all tasks with boxes, bins and mats on a table.

Importing it imports robosuite, which warns and takes seconds: go through `robosuite_import`.
"""

from typing import Any
from xml.etree import ElementTree

from robosuite.environments.manipulation.manipulation_env import ManipulationEnv
from robosuite.models.arenas import TableArena
from robosuite.models.objects import BoxObject
from robosuite.models.tasks import ManipulationTask
from robosuite.utils.mjcf_utils import CustomMaterial

from prime_envs_robosuite.tasks.table_top_objects import (
    FRICTION,
    TABLE_TOP,
    Bin,
    Box,
    Layout,
    Look,
    Mat,
)

Element = ElementTree.Element

TABLE_SIZE = (0.8, 0.8, 0.05)  # [m]
TABLE_FRICTION = (FRICTION, 0.005, 0.0001)  # sliding; torsional and rolling as MuJoCo's own
AGENTVIEW = ((0.571, 0.0, 1.421), (0.653, 0.271, 0.271, 0.653))  # position [m] and quaternion
ONLY_SHOWS = {"contype": "0", "conaffinity": "0", "group": "1"}
PAINT = 0.0005  # half of a mat's thickness [m]


class TableTop(ManipulationEnv):  # type: ignore[misc]
    """Boxes on a table with open bins and painted mats, which stay where they are.

    Args:
        layout: What is on the table.
        settings: As for robosuite's own class.
    """

    def __init__(self, layout: Layout, **settings: Any) -> None:
        self.layout = layout
        super().__init__(initialization_noise="default", **settings)

    def reward(self, action: Any = None) -> float:
        """Success is not judged here; see `Task.is_success`."""
        return 0.0

    def _load_model(self) -> None:
        super()._load_model()
        robot = self.robots[0].robot_model
        robot.set_base_xpos(robot.base_xpos_offset["table"](TABLE_SIZE[0]))
        arena = TableArena(TABLE_SIZE, TABLE_FRICTION, (0.0, 0.0, TABLE_TOP))
        arena.set_origin([0, 0, 0])
        arena.set_camera("agentview", *AGENTVIEW)
        for item in self.layout.bins:
            arena.worldbody.append(_bin_body(item, _add_look(arena, item.name, item.look)))
        for number, mat in enumerate(self.layout.mats):
            arena.worldbody.append(_mat(mat, _add_look(arena, f"mat{number}", mat.look)))
        boxes = [_box_object(box) for box in self.layout.boxes]
        self.model = ManipulationTask(arena, [robot], boxes)


def _texture(look: Look) -> dict[str, str]:
    """Return the attributes of a texture that MuJoCo paints by itself."""
    painted = {"rgb1": look.colour, "rgb2": look.colour, "markrgb": look.specks}
    colours = {key: " ".join(map(str, colour)) for key, colour in painted.items()}
    specks = {"mark": "random", "random": str(look.share), "width": "64", "height": "64"}
    return {"type": "cube", "builtin": "flat", **specks, **colours}


def _box_object(box: Box) -> Any:
    """Return robosuite's model of a box."""
    material = CustomMaterial(None, "texture", "look", _texture(box.look), {"specular": "0.2"})
    return BoxObject(box.name, size=box.half_size, friction=TABLE_FRICTION, material=material)


def _add_look(arena: Any, name: str, look: Look) -> str:
    """Add texture and material to an arena; return the material's name."""
    texture = {"name": f"{name}_texture", **_texture(look)}
    material = {"name": f"{name}_look", "texture": f"{name}_texture", "specular": "0.1"}
    ElementTree.SubElement(arena.asset, "texture", texture)
    ElementTree.SubElement(arena.asset, "material", material)
    return material["name"]


def _bin_body(item: Bin, material: str) -> Element:
    """Return the body of a bin: boxes that collide, and the same ones to look at."""
    body = ElementTree.Element("body", name=item.name, pos=_text(*item.centre, TABLE_TOP))
    for number, (centre, half_size) in enumerate(item.parts()):
        shape = {"type": "box", "pos": _text(*centre), "size": _text(*half_size)}
        solid = {"name": f"{item.name}_{number}", "group": "0", "friction": _text(*TABLE_FRICTION)}
        ElementTree.SubElement(body, "geom", {**shape, **solid})
        seen = {"name": f"{item.name}_{number}_visual", "material": material, **ONLY_SHOWS}
        ElementTree.SubElement(body, "geom", {**shape, **seen})
    return body


def _mat(mat: Mat, material: str) -> Element:
    """Return the geom of a painted mat, which collides with nothing."""
    return ElementTree.Element(
        "geom",
        {
            "name": material.replace("_look", "_visual"),
            "type": "box",
            "pos": _text(*mat.centre, TABLE_TOP),
            "size": _text(*mat.half_size, PAINT),
            "material": material,
            **ONLY_SHOWS,
        },
    )


def _text(*numbers: float) -> str:
    return " ".join(repr(float(number)) for number in numbers)

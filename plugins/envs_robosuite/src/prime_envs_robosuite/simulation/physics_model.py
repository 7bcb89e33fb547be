"""From a robosuite host to MuJoCo models: one for physics alone, one to look at.

Nothing reads the gripper's force and torque sensors, for which MuJoCo would work out the forces on
every body. Leaving out what only shows (the robot's look is 185 thousand mesh faces) changes no
number of the physics: robosuite takes masses from collision geoms and explicit inertias alone.
"""

from collections.abc import Sequence
from types import MappingProxyType
from typing import Any
from xml.etree import ElementTree

from prime_envs_robosuite.simulation.object_geoms import Geoms, only_shows, put_geoms, read_geoms

Element = ElementTree.Element


def physics_model(host: Any, geoms: Geoms = MappingProxyType({})) -> Any:
    """Compile a host's model without sensors and without what only shows.

    Args:
        host: A robosuite environment.
        geoms: Of objects that are to have other shapes.

    Returns:
        A ``mujoco.MjModel`` with the same state as the host's: the same bodies, joints,
        actuators and collision geoms.
    """
    root = ElementTree.fromstring(model_xml(host))
    put_geoms(root, geoms)
    for body in [*root.iter("worldbody"), *root.iter("body")]:
        for geom in body.findall("geom"):
            if only_shows(geom):
                body.remove(geom)
            elif "material" in geom.attrib:
                del geom.attrib["material"]
    for sensors in root.findall("sensor"):
        root.remove(sensors)
    _drop_unused_assets(root)
    return _compile(ElementTree.tostring(root, encoding="unicode"), host)


def show_physics(host: Any, model: Any, data: Any) -> None:
    """Let a host's own checks, such as that of success, look at other physics than its own.

    Args:
        host: A robosuite environment.
        model: What `physics_model` compiled of it.
        data: The ``mujoco.MjData`` that is stepped.
    """
    from robosuite.utils.binding_utils import MjModel

    wrapped = MjModel(model)
    numbers = {name: number for number, name in enumerate(wrapped.geom_names)}
    # It asks for what only shows, too, for pictures that are not made: those get numbers of none.
    wrapped.geom_name2id = lambda name: numbers.setdefault(name, model.ngeom + len(numbers))
    host.sim.model, host.sim.data._model, host.sim.data._data = wrapped, wrapped, data
    host._setup_references()  # geoms have other numbers where fewer are left


def visual_model(host: Any) -> Any:
    """Compile a host's whole model.

    Args:
        host: A robosuite environment.

    Returns:
        A ``mujoco.MjModel`` with the same positions ``qpos`` as the physics model.
    """
    return _compile(model_xml(host), host)


def model_xml(host: Any) -> str:
    """Return the XML that a host's simulation is made from, with absolute file names."""
    return str(host.edit_model_xml(host.model.get_xml()))


def object_geoms(host: Any, names: Sequence[str]) -> Geoms:
    """Return what objects of a host's model collide with, by the names of their bodies.

    Args:
        host: A robosuite environment.
        names: Of the bodies.
    """
    root = ElementTree.fromstring(model_xml(host))
    bodies = {body.get("name", ""): body for body in root.iter("body")}
    return {name: read_geoms(root, bodies[name]) for name in names}


def _drop_unused_assets(root: Element) -> None:
    """Remove the files that no geom names any more; they take most of the loading time."""
    assets = root.find("asset")
    if assets is None:
        return
    used = {geom.get("mesh") for geom in root.iter("geom")}
    for asset in list(assets):
        if asset.tag != "mesh" or asset.get("name") not in used:
            assets.remove(asset)


def _compile(xml: str, host: Any) -> Any:
    import mujoco

    model = mujoco.MjModel.from_xml_string(xml)
    # robosuite moves the bins and the pictures of the targets in its compiled model only.
    model.body_pos[:] = host.sim.model.body_pos
    model.body_quat[:] = host.sim.model.body_quat
    return model

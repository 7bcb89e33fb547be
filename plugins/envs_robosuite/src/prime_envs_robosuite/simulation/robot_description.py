"""The arm's kinematics as a MuJoCo model that loads from its string alone."""

from copy import deepcopy
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.description import RobotDescription
from prime_envs_robosuite.simulation.object_geoms import only_shows
from prime_envs_robosuite.simulation.panda import FINGER_BODIES, GRIP_SITE, JOINT_NAMES
from prime_envs_robosuite.simulation.physics_model import model_xml

Element = ElementTree.Element

END_EFFECTOR = "gripper"
BASE_BODY = "robot0_base"
MOUNT_BODY = "fixed_mount0_base"
HAND_PREFIX = "gripper0"
FURNITURE_BODIES = ("table", "bin0", "bin1", "bin2", "peg1", "peg2")
VELOCITY_LIMITS = (2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61)  # Franka's data sheet
FINGER_STROKE = 0.04  # [m]
QUARTER_TURN = "0.7071067811865476 0 0 0.7071067811865476"  # grip site to gripper, about z


def describe_robot(host: Any, model: Any) -> RobotDescription:
    """Describe a host's arm.

    Args:
        host: A robosuite environment with one Panda.
        model: The ``mujoco.MjModel`` of its physics, for the sizes of the hand's meshes.

    Returns:
        The arm at its base pose, hand and opened fingers as boxes, tables, bins and pegs as
        they are.
        The fingers have no joints; the site of the end effector is in the gripper's frame.
    """
    source = ElementTree.fromstring(model_xml(host)).find("worldbody")
    assert source is not None, "robosuite's XML has a worldbody"
    root = ElementTree.Element("mujoco", model="panda")
    # Without limits of inertia: the arm's bodies carry theirs, and the base has none.
    ElementTree.SubElement(root, "compiler", angle="radian", autolimits="true")
    world = ElementTree.SubElement(root, "worldbody")
    furniture = _furniture(world, source)
    base = deepcopy(_body(source, BASE_BODY))
    hand = _simplify_arm(base, model)
    world.append(base)
    return RobotDescription(
        mjcf=ElementTree.tostring(root, encoding="unicode"),
        joint_names=JOINT_NAMES,
        end_effector=END_EFFECTOR,
        hand_geoms=hand,
        furniture_geoms=furniture,
        joint_velocity_limits=VELOCITY_LIMITS,
        name="panda",
    )


def _furniture(world: Element, source: Element) -> tuple[str, ...]:
    """Copy what tables, bins and pegs collide with; return the geoms' names."""
    names = []
    for body_name in FURNITURE_BODIES:
        original = source.find(f"./body[@name='{body_name}']")
        if original is None:
            continue
        body = ElementTree.SubElement(world, "body", _only(original, "name", "pos", "quat"))
        solid = [geom for geom in original.findall("geom") if not only_shows(geom)]
        for number, geom in enumerate(solid):
            name = f"{body_name}_{number}"
            shape = _only(geom, "type", "size", "pos", "quat")
            ElementTree.SubElement(body, "geom", {"name": name, **shape})
            names.append(name)
    return tuple(names)


def _simplify_arm(base: Element, model: Any) -> tuple[str, ...]:
    """Strip an arm to kinematics and boxes, in place; return the names of the hand's geoms."""
    base.remove(_body(base, MOUNT_BODY))
    hand = []
    for body in base.iter("body"):
        for child in list(body):
            name = child.get("name", "")
            if child.tag == "geom" and name.startswith(HAND_PREFIX) and not only_shows(child):
                child.attrib = _box(model, name)
                hand.append(name)
            elif child.tag == "site" and name == GRIP_SITE:
                child.attrib = {**_only(child, "pos"), "name": END_EFFECTOR, "quat": QUARTER_TURN}
            elif child.tag not in ("body", "joint", "inertial"):
                body.remove(child)
    # robosuite gives the base an inertia of zero, which MuJoCo takes beside meshes only.
    for inertia in base.findall("inertial"):
        base.remove(inertia)
    _open_fingers(base)
    return tuple(hand)


def _only(element: Element, *keys: str) -> dict[str, str]:
    """Return those of an element's attributes that it has."""
    return {key: element.attrib[key] for key in keys if key in element.attrib}


def _box(model: Any, name: str) -> dict[str, str]:
    """Return the attributes of the box around a geom, in the frame of the geom's body."""
    import mujoco

    geom = model.geom(name)
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, geom.quat)
    bounds = model.geom_aabb[geom.id]
    centre = geom.pos + rotation.reshape(3, 3) @ bounds[:3]
    numbers = {"pos": centre, "quat": geom.quat, "size": bounds[3:]}
    return {"name": name, "type": "box", **{key: _text(item) for key, item in numbers.items()}}


def _open_fingers(base: Element) -> None:
    """Fix the fingers where they are widest apart."""
    for name, side in zip(FINGER_BODIES, (1.0, -1.0), strict=True):
        finger = _body(base, name)
        joint = finger.find("joint")
        assert joint is not None, "a finger slides"
        finger.remove(joint)
        for child in [*finger.findall("geom"), *finger.findall("body")]:
            offset = np.array([float(value) for value in child.get("pos", "0 0 0").split()])
            offset[1] += side * FINGER_STROKE
            child.set("pos", _text(offset))


def _text(numbers: NDArray[np.float64]) -> str:
    """Write numbers so that they are read back exactly."""
    return " ".join(repr(float(number)) for number in numbers)


def _body(parent: Element, name: str) -> Element:
    found = parent.find(f".//body[@name='{name}']")
    assert found is not None, f"robosuite's Panda has a body {name}"
    return found

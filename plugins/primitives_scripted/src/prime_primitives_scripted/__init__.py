"""Scripted primitives: reach, grasp and place for a parallel-jaw gripper that points down."""

from prime_core.hookspecs import Register, hookimpl
from prime_primitives_scripted.grasp import GraspConfig
from prime_primitives_scripted.place import PlaceConfig
from prime_primitives_scripted.reach import ReachConfig

__all__ = ["GraspConfig", "PlaceConfig", "ReachConfig", "register_primitives"]


@hookimpl
def register_primitives(register: Register) -> None:
    """Register the scripted primitives."""
    register("scripted/grasp", GraspConfig)
    register("scripted/place", PlaceConfig)
    register("scripted/reach", ReachConfig)

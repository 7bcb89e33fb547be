"""Scripted primitives: reach, grasp, place and push, within the limits of the arm."""

from prime_core.hookspecs import Register, hookimpl


@hookimpl
def register_primitives(register: Register) -> None:
    """Register the primitives of this pack."""
    from prime_primitives_scripted.grasp import GraspConfig
    from prime_primitives_scripted.place import PlaceConfig
    from prime_primitives_scripted.push import PushConfig
    from prime_primitives_scripted.reach import ReachConfig

    register("scripted/reach", ReachConfig)
    register("scripted/grasp", GraspConfig)
    register("scripted/place", PlaceConfig)
    register("scripted/push", PushConfig)

"""Primitives learned from segments of demonstrations.

`frame` is what a learned primitive sees of the world, `examples` and `disturbances` what it learns
from, `statistics` what segments tell of it besides, `primitive` the primitive at work.
Importing this package loads no torch: the policies that move the arm are found by their names.
"""

from prime_core.hookspecs import Register, hookimpl


@hookimpl
def register_primitives(register: Register) -> None:
    """Register the primitives of this pack."""
    from prime_primitives_learned.config import (
        AnyConfig,
        GraspConfig,
        PlaceConfig,
        PushConfig,
        ReachConfig,
    )

    register("learned/reach", ReachConfig)
    register("learned/grasp", GraspConfig)
    register("learned/place", PlaceConfig)
    register("learned/push", PushConfig)
    register("learned/any", AnyConfig)

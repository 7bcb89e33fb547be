"""robosuite tasks as prime environments. Importing this imports neither robosuite nor MuJoCo."""

from prime_core.hookspecs import Register, hookimpl
from prime_envs_robosuite.config import LiftConfig, PickPlaceConfig, RobosuiteConfig

__all__ = ["LiftConfig", "PickPlaceConfig", "RobosuiteConfig", "register_environments"]


@hookimpl
def register_environments(register: Register) -> None:
    """Register the environments of this pack."""
    register("robosuite/lift", LiftConfig)
    register("robosuite/pick-place", PickPlaceConfig)

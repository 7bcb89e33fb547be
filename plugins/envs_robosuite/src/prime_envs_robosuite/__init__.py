"""robosuite tasks as prime environments, and demonstrations of them.

Importing this imports neither robosuite nor MuJoCo.
"""

from prime_core.hookspecs import Register, hookimpl


@hookimpl
def register_environments(register: Register) -> None:
    """Register the environments of this pack."""
    from prime_envs_robosuite.config import (
        CleanUpConfig,
        LiftConfig,
        NutAssemblyConfig,
        PickPlaceConfig,
        TidyUpConfig,
    )

    register("robosuite/clean-up", CleanUpConfig)
    register("robosuite/lift", LiftConfig)
    register("robosuite/nut-assembly", NutAssemblyConfig)
    register("robosuite/pick-place", PickPlaceConfig)
    register("robosuite/tidy-up", TidyUpConfig)


@hookimpl
def register_demonstrators(register: Register) -> None:
    """Register the simulated teleoperator and the importer of robosuite's recordings."""
    from prime_envs_robosuite.robosuite_hdf5 import RobosuiteHdf5Config
    from prime_envs_robosuite.teleoperator import SimulatedTeleoperatorConfig

    register("simulated-teleoperator", SimulatedTeleoperatorConfig)
    register("robosuite-hdf5", RobosuiteHdf5Config)

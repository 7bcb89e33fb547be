"""robosuite tasks as prime environments, and demonstrations of them.

Each part imports only those before it: ``simulation``, ``pictures``, ``tasks``,
``robosuite_tasks``, the files beside this one (``environment.py``, its settings ``config.py``,
``recorder.py``), then ``demonstrators`` and ``recordings``, which do not know each other. What is
new is registered here. Importing this imports neither robosuite nor MuJoCo.
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
        StackConfig,
        TaskConfig,
        TidyUpConfig,
    )

    register("robosuite/clean-up", CleanUpConfig)
    register("robosuite/lift", LiftConfig)
    register("robosuite/nut-assembly", NutAssemblyConfig)
    register("robosuite/pick-place", PickPlaceConfig)
    register("robosuite/stack", StackConfig)
    register("robosuite/task", TaskConfig)
    register("robosuite/tidy-up", TidyUpConfig)


@hookimpl
def register_demonstrators(register: Register) -> None:
    """Register the simulated teleoperator and the importer of robosuite's recordings."""
    from prime_envs_robosuite.demonstrators.simulated_teleoperator import (
        SimulatedTeleoperatorConfig,
    )
    from prime_envs_robosuite.recordings.robosuite_hdf5 import RobosuiteHdf5Config

    register("simulated-teleoperator", SimulatedTeleoperatorConfig)
    register("robosuite-hdf5", RobosuiteHdf5Config)


@hookimpl
def register_exporters(register: Register) -> None:
    """Register robomimic's files."""
    from prime_envs_robosuite.recordings.robomimic_export import RobomimicConfig

    register("robomimic", RobomimicConfig)

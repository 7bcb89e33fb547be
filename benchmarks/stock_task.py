"""robosuite's own tasks, as they are installed, for benchmarks to compare with."""

from typing import Any

from prime_envs_robosuite.mujoco_import import import_mujoco
from prime_envs_robosuite.tasks.robosuite_import import quiet_robosuite


def stock_task(name: str, pictures: bool = False) -> Any:
    """Make a task of robosuite, which renders only if it is to.

    Args:
        name: robosuite's own of the task.
        pictures: Whether it renders off screen.
    """
    import_mujoco()
    with quiet_robosuite():
        import robosuite

        return robosuite.make(
            name,
            robots="Panda",
            has_renderer=False,
            has_offscreen_renderer=pictures,
            use_camera_obs=False,
            hard_reset=False,
            ignore_done=True,
        )

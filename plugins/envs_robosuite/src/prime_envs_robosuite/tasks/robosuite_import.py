"""The one door to robosuite: imports it quietly and builds the hosts of our models.

A host is a robosuite environment that the model's XML, the placement ranges and the names
are read from. It is stepped only where stock stepping is asked for.
"""

import logging
import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Literal

import numpy as np

HostName = Literal["FixedCubeLift", "OneNutAssembly", "OneObjectPickPlace", "TableTop"]


def make_host(name: HostName, **settings: Any) -> Any:
    """Build a robosuite task with one Panda and its default OSC_POSE controller.

    Args:
        name: A class of `robosuite_models` or `table_top_model`.
        settings: The class's own arguments.

    Returns:
        The robosuite environment, never reset by its own ``reset``.
    """
    with quiet_robosuite(), _global_state_kept():
        # robosuite takes seconds to import: only where a host is built.
        from prime_envs_robosuite.tasks.robosuite_models import (
            FixedCubeLift,
            OneNutAssembly,
            OneObjectPickPlace,
        )
        from prime_envs_robosuite.tasks.table_top_model import TableTop

        classes = (FixedCubeLift, OneNutAssembly, OneObjectPickPlace, TableTop)
        return {found.__name__: found for found in classes}[name](
            robots="Panda",
            has_renderer=False,
            has_offscreen_renderer=False,
            use_camera_obs=False,
            ignore_done=True,
            hard_reset=False,
            control_freq=20,
            **settings,
        )


@contextmanager
def quiet_robosuite() -> Iterator[None]:
    """Hold back robosuite's start-up messages; errors still show."""
    logger = logging.getLogger("robosuite_logs")

    def errors_only(record: logging.LogRecord) -> bool:
        return record.levelno >= logging.ERROR

    logger.addFilter(errors_only)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.removeFilter(errors_only)


@contextmanager
def _global_state_kept() -> Iterator[None]:
    """Undo what robosuite does to numpy's global generator and to the user's MUJOCO_GL.

    The device for pictures is hidden from it: it asserts that CUDA may use it, and we do not render
    with robosuite.
    """
    state = np.random.get_state()
    kept = {name: os.environ.get(name) for name in ("MUJOCO_GL", "MUJOCO_EGL_DEVICE_ID")}
    os.environ.pop("MUJOCO_EGL_DEVICE_ID", None)
    try:
        yield
    finally:
        np.random.set_state(state)
        os.environ.update({name: value for name, value in kept.items() if value is not None})

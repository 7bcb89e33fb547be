"""The edge to robosuite: quiet import, version guard and hosts for the models.

A host is a robosuite environment that the model's XML, the placement ranges and the names
are read from. It is stepped only where stock stepping is asked for.
"""

import logging
import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from prime_core.errors import PrimeError

COMPARED_VERSIONS = ("1.5.1",)


def make_host(class_name: str, **settings: Any) -> Any:
    """Build a robosuite task with one Panda and its default OSC_POSE controller.

    Args:
        class_name: A class of `robosuite_tasks`.
        settings: The class's own arguments.

    Returns:
        The robosuite environment, never reset by its own ``reset``.
    """
    with quiet_robosuite(), _global_state_kept():
        from prime_envs_robosuite import robosuite_tasks

        return getattr(robosuite_tasks, class_name)(
            robots="Panda",
            has_renderer=False,
            has_offscreen_renderer=False,
            use_camera_obs=False,
            ignore_done=True,
            hard_reset=False,
            control_freq=20,
            **settings,
        )


def check_control_law(version: str) -> None:
    """Raise if a version of robosuite was not compared with the compiled control law.

    Args:
        version: Of robosuite, such as ``"1.5.1"``.

    Raises:
        PrimeError: If the compiled law may differ from that version's.
    """
    if version not in COMPARED_VERSIONS:
        known = ", ".join(COMPARED_VERSIONS)
        raise PrimeError(
            f"stepping: compiled was compared with robosuite {known}, not with the installed "
            f"{version}: install robosuite=={COMPARED_VERSIONS[-1]} or set stepping: stock"
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
    """Undo what robosuite does to numpy's global generator and to the user's MUJOCO_GL."""
    state = np.random.get_state()
    library = os.environ.get("MUJOCO_GL")
    try:
        yield
    finally:
        np.random.set_state(state)
        if library is not None:
            os.environ["MUJOCO_GL"] = library

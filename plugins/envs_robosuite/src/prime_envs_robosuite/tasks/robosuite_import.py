"""The one door to robosuite: imports it quietly and builds the hosts of our models.

A host is a robosuite environment that the model's XML, the placement ranges and the names
are read from. It is stepped only where stock stepping is asked for.
"""

import difflib
import logging
import os
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Literal

import numpy as np

from prime_core.arrays import Array
from prime_core.errors import ConfigurationError, PrimeError

ROBOT, GRIPPER = "Panda", "PandaGripper"
HostName = Literal["FixedCubeLift", "NutAssemblyOf", "PickPlaceOf", "TableTop"]
"""A class of `robosuite_models` or `table_top_model`."""

GROCERIES = ("Milk", "Bread", "Cereal", "Can")  # in robosuite's order
NUTS = ("SquareNut", "RoundNut")  # likewise
CUBE_HALF_SIZE = 0.021  # of Lift's cube; robosuite draws 0.020 to 0.022 at every hard reset [m]

SMALLER_HOSTS: dict[str, tuple[HostName, dict[str, Any]]] = {
    "Lift": ("FixedCubeLift", {"cube_half_size": CUBE_HALF_SIZE}),
    **{f"PickPlace{name}": ("PickPlaceOf", {"names": (name,)}) for name in GROCERIES},
    **{
        f"NutAssembly{name.removesuffix('Nut')}": ("NutAssemblyOf", {"names": (name,)})
        for name in NUTS
    },
}
"""Our class and its arguments by the name of the robosuite task that it stands for."""


def make_host(name: HostName, **settings: Any) -> Any:
    """Build a robosuite task with one Panda and its default OSC_POSE controller.

    Args:
        name: A class of `robosuite_models` or `table_top_model`.
        settings: The class's own arguments.

    Returns:
        The robosuite environment, never reset by its own ``reset``.
    """
    with quiet_robosuite(), seeded_globals(0):
        # robosuite takes seconds to import: only where a host is built.
        from prime_envs_robosuite.tasks.robosuite_models import (
            FixedCubeLift,
            NutAssemblyOf,
            PickPlaceOf,
        )
        from prime_envs_robosuite.tasks.table_top_model import TableTop

        classes = (FixedCubeLift, NutAssemblyOf, PickPlaceOf, TableTop)
        return _build({found.__name__: found for found in classes}[name], settings)


def make_robosuites_own(name: str) -> Any:
    """Build any task of robosuite's, as `make_host` does.

    Args:
        name: robosuite's name of it, such as ``"Stack"``.

    Raises:
        ConfigurationError: If there is no such task, or not for one arm.
    """
    if name in SMALLER_HOSTS:
        smaller, settings = SMALLER_HOSTS[name]
        return make_host(smaller, **settings)
    with quiet_robosuite(), seeded_globals(0):
        from robosuite.environments.base import REGISTERED_ENVS
        from robosuite.environments.manipulation.two_arm_env import TwoArmEnv

        known = {
            key: found
            for key, found in REGISTERED_ENVS.items()
            if not found.__module__.startswith("prime_envs_robosuite.")
        }
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1, cutoff=0.4)
            guess = f" Did you mean {near[0]!r}?" if near else ""
            raise ConfigurationError(
                f"environment 'robosuite/task': robosuite has no task named {name!r}.{guess} "
                f"There are: {', '.join(sorted(known))}"
            )
        if issubclass(known[name], TwoArmEnv):
            raise ConfigurationError(
                f"environment 'robosuite/task': robosuite's {name} is for two arms; here is one, "
                f"a {ROBOT}"
            )
        return _build(known[name], {})


def _build(found: Any, settings: dict[str, Any]) -> Any:
    """Build a robosuite environment of a class with our robot and rate."""
    return found(
        robots=ROBOT,
        has_renderer=False,
        has_offscreen_renderer=False,
        use_camera_obs=False,
        ignore_done=True,
        hard_reset=False,
        control_freq=20,
        **settings,
    )


def sample_poses(host: Any, names: Sequence[str], rng: np.random.Generator) -> Array:
    """Draw poses with a robosuite task's own sampler.

    Args:
        host: The robosuite environment.
        names: robosuite's names of the objects.
        rng: Where all draws come from.

    Returns:
        Positions [m], world frame, and quaternions, ``(k, 7)``.

    Raises:
        PrimeError: If the sampler finds no room for all of them.
    """
    from robosuite.utils.errors import RandomizationError

    with seeded_globals(int(rng.integers(2**32))):
        try:
            found = host.placement_initializer.sample()
        except RandomizationError as error:
            raise PrimeError(f"robosuite's sampler found no start: {error}") from error
    return np.array([[*found[name][0], *found[name][1]] for name in names])


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
def seeded_globals(seed: int) -> Iterator[None]:
    """Seed numpy's global generator, which robosuite draws from; then undo what robosuite did.

    That is to numpy's global generator and to the user's MUJOCO_GL. The device for pictures is
    hidden from it: it asserts that CUDA may use it, and we do not render with robosuite.

    Args:
        seed: So that sizes which robosuite draws are the same in every process.
    """
    state = np.random.get_state()
    kept = {name: os.environ.get(name) for name in ("MUJOCO_GL", "MUJOCO_EGL_DEVICE_ID")}
    os.environ.pop("MUJOCO_EGL_DEVICE_ID", None)
    np.random.seed(seed)
    try:
        yield
    finally:
        np.random.set_state(state)
        os.environ.update({name: value for name, value in kept.items() if value is not None})

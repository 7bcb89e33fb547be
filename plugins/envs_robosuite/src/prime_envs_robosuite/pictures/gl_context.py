"""The one OpenGL context of a process, and what is told where there is none."""

import atexit
import os
import sys
import warnings
from functools import cache
from typing import Any

from prime_core.errors import PrimeError

OFF = ("disable", "disabled", "off", "false", "0")
WINDOW_SYSTEM = ("glfw", "glx", "wgl", "enable", "enabled", "on", "true", "1")
WINDOW = 64  # pixels; pictures are rendered in buffers of MuJoCo's


def make_contexts(model: Any) -> tuple[Any, Any]:
    """Make MuJoCo's context of a model in the one of the library that MUJOCO_GL names.

    ``mujoco.Renderer`` would choose its library when mujoco is imported, before robosuite
    and we can choose one that needs no screen.

    Args:
        model: A ``mujoco.MjModel``.

    Returns:
        The library's context, of which a process has one, and a ``mujoco.MjrContext``.

    Raises:
        PrimeError: If there is none; the text says what to do.
    """
    import mujoco

    library = os.environ.get("MUJOCO_GL", "").lower().strip()
    try:
        context = _context(library)
        context.make_current()
        return context, mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
    except Exception as error:  # each library fails with errors of its own
        reason = next(iter(str(error).strip().splitlines()), "")
        raise PrimeError(
            f"no picture can be rendered with MUJOCO_GL={library or 'unset'} "
            f"({type(error).__name__}: {reason}); without a screen set MUJOCO_GL=egl (Debian: "
            "libegl1 libgl1-mesa-dri) or MUJOCO_GL=osmesa (libosmesa6)"
        ) from error


@cache
def _context(library: str) -> Any:
    with warnings.catch_warnings():  # GLFW warns where it has no screen, and goes on
        warnings.simplefilter("ignore")
        context = _library(library)(WINDOW, WINDOW)
        context.make_current()
        if type(context).__module__ == "mujoco.glfw":
            _require_window()
    # Registered after the library's own exit, so that it runs before it.
    atexit.register(context.free)
    return context


def _require_window() -> None:
    """Raise unless GLFW has made a context, for MuJoCo aborts at the second try without one."""
    import glfw

    if not glfw.get_current_context():
        raise RuntimeError("there is no screen")


def _library(name: str) -> Any:
    """Return the class of contexts that a value of MUJOCO_GL stands for, EGL's by default on Linux.

    Raises:
        ValueError: If it stands for none.
    """
    if not name:
        name = "egl" if sys.platform.startswith("linux") else "glfw"
    if name in OFF:
        raise ValueError("it turns pictures off")
    if name == "egl":
        from mujoco.egl import GLContext
    elif name == "osmesa":
        from mujoco.osmesa import GLContext
    elif name == "cgl":
        from mujoco.cgl import GLContext
    elif name in WINDOW_SYSTEM:
        from mujoco.glfw import GLContext
    else:
        raise ValueError("there is no such library")
    return GLContext

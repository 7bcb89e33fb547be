"""Pictures of a scene, off screen, made only when asked for."""

import atexit
import os
import sys
import warnings
import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.errors import PrimeError
from prime_envs_robosuite.simulation.physics_model import visual_model

# Our names of the cameras that policies look through; all others keep robosuite's names.
ALIASES = {"agentview": "agentview", "wrist": "robot0_eye_in_hand"}
COLLISION_GROUP = 0
OFF = ("disable", "disabled", "off", "false", "0")
WINDOW_SYSTEM = ("glfw", "glx", "wgl", "enable", "enabled", "on", "true", "1")
GREATEST_COUNT = 2000  # geoms in a picture; robosuite's scenes have some 130


class Cameras:
    """Renders a host's whole model, posed like the physics model.

    The model with all meshes is compiled at the first picture. Shadows, reflections and
    multisampling are left out: they take half the time of a picture without a GPU.

    Args:
        host: A robosuite environment.
    """

    def __init__(self, host: Any) -> None:
        self._host = host
        self._names = {**ALIASES, **{name: name for name in host.sim.model.camera_names}}
        self._picture: _Picture | None = None

    def check(self, name: str) -> None:
        """Raise a PrimeError if there is no such camera."""
        if name not in self._names:
            known = ", ".join(sorted(self._names))
            raise PrimeError(f"there is no camera {name!r}; there are: {known}")

    def picture(
        self, name: str, positions: NDArray[np.float64], height: int, width: int
    ) -> NDArray[np.uint8]:
        """Render one camera.

        Args:
            name: Of the camera.
            positions: ``qpos`` of the physics model, ``(nq,)``.
            height: [pixels].
            width: [pixels].

        Returns:
            ``(height, width, 3)``, first row at the top.

        Raises:
            PrimeError: If there is no such camera, or no library to render with.
        """
        self.check(name)
        if self._picture is None or not self._picture.holds(height, width):
            self.close()
            self._picture = _Picture(visual_model(self._host), height, width)
        return self._picture.render(self._names[name], positions, height, width)

    def close(self) -> None:
        """Free the renderer."""
        if self._picture is not None:
            self._picture.close()
            self._picture = None


class _Picture:
    """An off-screen buffer that pictures up to a size are rendered in.

    ``mujoco.Renderer`` would choose its library when mujoco is imported, before robosuite
    and we can choose one that needs no screen.

    Args:
        model: The ``mujoco.MjModel`` to look at.
        height: Greatest height [pixels].
        width: Greatest width [pixels].
    """

    def __init__(self, model: Any, height: int, width: int) -> None:
        import mujoco

        buffer = model.vis.global_
        buffer.offheight, buffer.offwidth = (
            max(buffer.offheight, height),
            max(buffer.offwidth, width),
        )
        model.vis.quality.offsamples = 0
        self._size = (buffer.offheight, buffer.offwidth)
        self._model, self._data = model, mujoco.MjData(model)
        self._library, self._context = _contexts(model, *self._size)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self._scene = mujoco.MjvScene(model, GREATEST_COUNT)
        for flag in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION):
            self._scene.flags[flag] = False
        self._options = mujoco.MjvOption()
        self._free = weakref.finalize(self, _free, self._library, self._context)
        # Registered after the library's own exit, so that it runs before it.
        atexit.register(self._free)
        # Else collision shapes are painted over the robot.
        self._options.geomgroup[COLLISION_GROUP] = 0
        self._options.sitegroup[:] = 0

    def holds(self, height: int, width: int) -> bool:
        return bool(height <= self._size[0] and width <= self._size[1])

    def render(
        self, name: str, positions: NDArray[np.float64], height: int, width: int
    ) -> NDArray[np.uint8]:
        import mujoco

        self._data.qpos[:] = positions
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        camera = mujoco.MjvCamera()
        camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        camera.fixedcamid = self._model.camera(name).id
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(
            self._model, self._data, self._options, None, camera, everything, self._scene
        )
        self._library.make_current()
        area = mujoco.MjrRect(0, 0, width, height)
        mujoco.mjr_render(area, self._scene, self._context)
        pixels = np.empty((height, width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(pixels, None, area, self._context)
        return np.ascontiguousarray(pixels[::-1])

    def close(self) -> None:
        self._free()
        atexit.unregister(self._free)


def _free(library: Any, context: Any) -> None:
    library.make_current()
    context.free()
    library.free()


def _contexts(model: Any, height: int, width: int) -> tuple[Any, Any]:
    """Make the context of the library that MUJOCO_GL names, and MuJoCo's in it.

    Raises:
        PrimeError: If there is none; the text says what to do.
    """
    import mujoco

    library = os.environ.get("MUJOCO_GL", "").lower().strip()
    try:
        with warnings.catch_warnings():  # GLFW warns where it has no screen, and goes on
            warnings.simplefilter("ignore")
            context = _library(library)(width, height)
            context.make_current()
            if type(context).__module__ == "mujoco.glfw":
                _require_window()
            font = mujoco.mjtFontScale.mjFONTSCALE_150.value
            return context, mujoco.MjrContext(model, font)
    except Exception as error:  # each library fails with errors of its own
        reason = next(iter(str(error).strip().splitlines()), "")
        raise PrimeError(
            f"no picture can be rendered with MUJOCO_GL={library or 'unset'} "
            f"({type(error).__name__}: {reason}); without a screen set MUJOCO_GL=egl (Debian: "
            "libegl1 libgl1-mesa-dri) or MUJOCO_GL=osmesa (libosmesa6)"
        ) from error


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

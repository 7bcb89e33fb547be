"""Pictures of a scene, off screen, made only when asked for."""

import atexit
import weakref
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from prime_core.errors import PrimeError
from prime_envs_robosuite.pictures.gl_context import make_contexts
from prime_envs_robosuite.pictures.light_meshes import lighten
from prime_envs_robosuite.simulation.physics_model import visual_model

Meshes = Literal["light", "full"]
"""``light`` meshes have few faces, for pictures of up to `LIGHT_SIZE`; ``full`` ones have all."""

LIGHT_SIZE = 256  # pixels; larger pictures show what light meshes lack
# Our names of the cameras that policies look through; all others keep robosuite's names.
ALIASES = {"agentview": "agentview", "wrist": "robot0_eye_in_hand"}
COLLISION_GROUP = 0
GREATEST_COUNT = 2000  # geoms in a picture; robosuite's scenes have some 130
SLICES, STACKS, QUADS = 16, 2, 4  # of cylinders around and along, and of boxes' sides


class Cameras:
    """Renders a host's whole model, posed like the physics model.

    The model with all meshes is compiled at the first picture.

    Args:
        host: A robosuite environment.
        meshes: Of pictures up to `LIGHT_SIZE`; larger ones have full meshes.
    """

    def __init__(self, host: Any, meshes: Meshes = "light") -> None:
        self._host = host
        self._meshes = meshes
        self._names = {**ALIASES, **{name: name for name in host.sim.model.camera_names}}
        self._looks: dict[Meshes, _Look] = {}

    def check(self, name: str) -> None:
        """Raise a PrimeError if there is no such camera."""
        if name not in self._names:
            known = ", ".join(sorted(self._names))
            raise PrimeError(f"there is no camera {name!r}; there are: {known}")

    def pictures(
        self, names: Sequence[str], positions: NDArray[np.float64], height: int, width: int
    ) -> dict[str, NDArray[np.uint8]]:
        """Render some cameras at some instants.

        Args:
            names: Of the cameras.
            positions: ``qpos`` of the physics model at each instant, ``(N, nq)``.
            height: [pixels].
            width: [pixels].

        Returns:
            By camera, ``(N, height, width, 3)``, first row at the top.

        Raises:
            PrimeError: If there is no such camera, or nothing to render with.
        """
        for name in names:
            self.check(name)
        found = {
            name: np.empty((len(positions), height, width, 3), dtype=np.uint8) for name in names
        }
        if len(positions):
            light = self._meshes == "light" and max(height, width) <= LIGHT_SIZE
            look = self._look("light" if light else "full")
            look.make_room(height, width)
            for row, instant in enumerate(positions):
                look.pose(instant)
                for name, images in found.items():
                    look.render(self._names[name], images[row])
        return found

    def close(self) -> None:
        """Free the renderers."""
        for look in self._looks.values():
            look.close()
        self._looks.clear()

    def _look(self, meshes: Meshes) -> "_Look":
        if meshes not in self._looks:
            model = visual_model(self._host)
            if meshes == "light":
                lighten(model)
                quality = model.vis.quality
                quality.numslices, quality.numstacks, quality.numquads = SLICES, STACKS, QUADS
            self._looks[meshes] = _Look(model)
        return self._looks[meshes]


class _Look:
    """A model to look at, and the buffer that its pictures are rendered in.

    Shadows, reflections and multisampling are left out: they take half the time of a picture
    without a GPU.

    Args:
        model: The ``mujoco.MjModel``.
    """

    def __init__(self, model: Any) -> None:
        import mujoco

        model.vis.quality.offsamples = 0
        self._size = (1, 1)
        model.vis.global_.offheight, model.vis.global_.offwidth = self._size
        self._model, self._data = model, mujoco.MjData(model)
        self._groups = model.geom_group.copy()
        self._gl, self._context = make_contexts(model)
        self._free = weakref.finalize(self, _free, self._gl, self._context)
        # Registered after the library's own exit, so that it runs before it.
        atexit.register(self._free)
        self._scene = mujoco.MjvScene(model, GREATEST_COUNT)
        for flag in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION):
            self._scene.flags[flag] = False
        self._options = mujoco.MjvOption()
        # Else collision shapes are painted over the robot.
        self._options.geomgroup[COLLISION_GROUP] = 0
        self._options.sitegroup[:] = 0

    def make_room(self, height: int, width: int) -> None:
        """Enlarge the buffer if pictures of that size do not fit: the whole of it is cleared."""
        import mujoco

        if height > self._size[0] or width > self._size[1]:
            self._size = (max(height, self._size[0]), max(width, self._size[1]))
            self._gl.make_current()
            mujoco.mjr_resizeOffscreen(self._size[1], self._size[0], self._context)

    def pose(self, positions: NDArray[np.float64]) -> None:
        """Put all that moves where it is at an instant, for all cameras: ``qpos``, ``(nq,)``."""
        import mujoco

        self._data.qpos[:] = positions
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)

    def render(self, name: str, image: NDArray[np.uint8]) -> None:
        """Fill an image, ``(height, width, 3)``."""
        import mujoco

        height, width, _ = image.shape
        camera = mujoco.MjvCamera()
        camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        camera.fixedcamid = self._model.camera(name).id
        seen = self._may_be_seen(camera.fixedcamid, width / height)
        self._model.geom_group[:] = np.where(seen, self._groups, COLLISION_GROUP)
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(
            self._model, self._data, self._options, None, camera, everything, self._scene
        )
        self._gl.make_current()
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        area = mujoco.MjrRect(0, 0, width, height)
        mujoco.mjr_render(area, self._scene, self._context)
        pixels = np.empty_like(image)
        mujoco.mjr_readPixels(pixels, None, area, self._context)
        image[:] = pixels[::-1]

    def _may_be_seen(self, camera: int, aspect: float) -> NDArray[np.bool_]:
        """Return which geoms' spheres reach into what a camera sees; MuJoCo would draw all."""
        model, data = self._model, self._data
        away = data.geom_xpos - data.cam_xpos[camera]
        right, up, back = (away @ data.cam_xmat[camera].reshape(3, 3)).T
        slope = np.tan(np.radians(model.cam_fovy[camera]) / 2)
        inside = back < model.geom_rbound
        for aside, steep in ((right, slope * aspect), (up, slope)):
            inside &= np.abs(aside) + back * steep < model.geom_rbound * np.hypot(1.0, steep)
        boundless = model.geom_rbound == 0  # planes
        return np.asarray(inside | boundless)

    def close(self) -> None:
        """Free the buffer and what was put into it."""
        self._free()
        atexit.unregister(self._free)


def _free(library: Any, context: Any) -> None:
    library.make_current()
    context.free()

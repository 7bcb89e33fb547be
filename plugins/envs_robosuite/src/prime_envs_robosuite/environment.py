"""The environment that all robosuite tasks share."""

import weakref
from collections.abc import Sequence
from typing import Any, cast

import gymnasium
import mujoco
import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import (
    ACTION_LIMIT,
    CONTROL_FREQUENCY,
    Environment,
    Observation,
)
from prime_core.contracts.observations import (
    ENVIRONMENT_STATE_KEY,
    IMAGE_PREFIX,
    STATE_KEY,
    Observations,
)
from prime_core.contracts.scene import ObjectPoses, Scene
from prime_core.errors import PrimeError
from prime_envs_robosuite.pictures.cameras import Cameras, Meshes
from prime_envs_robosuite.simulation.controller_commands import controller_command
from prime_envs_robosuite.simulation.object_geoms import Geoms
from prime_envs_robosuite.simulation.panda_simulation import Simulation
from prime_envs_robosuite.simulation.physics_model import object_geoms
from prime_envs_robosuite.simulation.robot_description import describe_robot
from prime_envs_robosuite.simulation.stepping import Stepping
from prime_envs_robosuite.tasks.task import Task

Array = NDArray[np.float64]
# Closed fingers touch with both what they push; what they hold is thicker [m].
CLOSED_OPENING = 0.005
PICTURE_SIZE = 256  # pixels


class RobosuiteEnvironment(Environment):
    """A robosuite task with a Panda, as a prime environment.

    Args:
        task: The task.
        stepping: How physics is advanced; see `simulation.stepping`.
        cameras: Cameras whose images are part of the observations.
        image_size: Height and width of those images [pixels].
        horizon: Steps after which an episode is truncated; None for never.
        meshes: What pictures are made of; see `pictures.cameras`.

    Raises:
        PrimeError: If a camera does not exist.
    """

    default_camera = "agentview"
    metadata = {"render_modes": ["rgb_array"], "render_fps": CONTROL_FREQUENCY}  # noqa: RUF012

    def __init__(
        self,
        task: Task,
        stepping: Stepping = "compiled",
        cameras: tuple[str, ...] = (),
        image_size: int = 84,
        horizon: int | None = None,
        meshes: Meshes = "light",
    ) -> None:
        self.task = task
        self.horizon = horizon
        self.render_mode = "rgb_array"
        host = task.make_host()
        # robosuite's parts point at each other: without this, the simulator's memory waits for
        # Python's collector of cycles, which counts objects and not their size.
        self._freed = weakref.finalize(self, host.close)
        self._freed.atexit = False
        self._simulation = Simulation(host, task.body_names, task.starts(host), stepping)
        self._judge = task.judge(host)
        self._cameras = Cameras(host, meshes)
        for name in cameras:
            self._cameras.check(name)
        self._images = {IMAGE_PREFIX + name: name for name in cameras}
        self._image_size = image_size
        self.description = self._describe()
        self.action_space = gymnasium.spaces.Box(-ACTION_LIMIT, ACTION_LIMIT, dtype=np.float64)
        self.observation_space = self._observation_space()
        self._elapsed = 0
        self._scene: Scene | None = None
        self._gripper_command: float | None = None  # the last one
        self._touched = False  # whether a finger touches an object in that scene

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode.

        Args:
            seed: Seeds all draws; None to go on drawing from the generator there is.
            options: None are known.

        Returns:
            The first observation, and ``{"is_success": bool}``.
        """
        super().reset(seed=seed)
        self._simulation.reset(self.np_random)
        self._elapsed = 0
        self._gripper_command = None
        self._scene = None
        return self._observation(), {"is_success": self.is_success()}

    def step(self, action: Array) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Take a motor action; see `Environment`.

        Args:
            action: dx, dy, dz [m], dyaw [rad] in the world frame; gripper, ``(5,)``.

        Returns:
            Observation, reward, terminated, truncated, ``{"is_success": bool}``.

        Raises:
            PrimeError: If the action is not five finite numbers.
        """
        values = np.asarray(action, dtype=np.float64)
        if values.shape != (5,) or not np.all(np.isfinite(values)):
            raise PrimeError(
                f"an action is 5 finite numbers (dx, dy, dz, dyaw, gripper); this one is {action}"
            )
        simulation = self._simulation
        command = controller_command(values, simulation.panda, simulation.data)
        simulation.stepper.step(command)
        self._gripper_command = float(command[6])
        self._elapsed += 1
        self._moved()
        success = self.is_success()
        truncated = self.horizon is not None and self._elapsed >= self.horizon
        return self._observation(), float(success), success, truncated, {"is_success": success}

    def scene(self) -> Scene:
        """Return the scene as it is now."""
        if self._scene is None:
            self._scene = self._read_scene()
        return self._scene

    def is_success(self) -> bool:
        """Whether the task is solved now."""
        scene = self.scene()
        return self._judge(scene, self._touched, self._simulation.motions())

    def get_state(self) -> Array:
        """Return all that the future depends on, ``(n,)``; see `Environment`.

        MuJoCo's integration state, the gripper's command, the rest posture, and the number
        of steps taken.
        """
        return np.append(self._simulation.get_state(), float(self._elapsed))

    def set_state(self, state: Array) -> None:
        """Restore a state; see `Environment`."""
        expected = self._simulation.state_size + 1
        values = np.asarray(state, dtype=np.float64)
        if values.shape != (expected,):
            raise PrimeError(
                f"a state of this environment has shape ({expected},), not {values.shape}"
            )
        self._simulation.set_state(values[:-1])
        self._elapsed = int(values[-1])
        self._gripper_command = None
        self._scene = None

    def set_joint_state(
        self, positions: Array, velocities: Array, gripper_command: float | None = None
    ) -> None:
        """Put all joints where they are told to be, to step on from there.

        For recordings that hold joints alone. The controller starts afresh, so this does
        not restore a state exactly.

        Args:
            positions: MuJoCo's ``qpos``: 7 arm joints [rad], 2 fingers [m], then for each
                object position [m] and quaternion, ``(nq,)``.
            velocities: MuJoCo's ``qvel``, ``(nv,)``.
            gripper_command: From -1 (open) to 1 (closed); None for the one that holds the
                fingers where they are, which does not press on an object between them.

        Raises:
            PrimeError: If the lengths are not the model's.
        """
        self._simulation.set_joint_state(positions, velocities, gripper_command)
        self._elapsed = 0
        self._gripper_command = None
        self._scene = None

    def own_geoms(self) -> Geoms:
        """Return what the objects collide with in robosuite's model, by their bodies, in order."""
        return object_geoms(self._simulation.host, self._simulation.object_bodies)

    def reshape_objects(self, geoms: Geoms) -> None:
        """Give the objects other shapes, those of a recording's model; none for their own.

        Pictures and the description stay those of robosuite's model, and so does the layout of
        states. The environment is then as it is before the first reset.

        Args:
            geoms: Of some objects, by the names of their bodies.
        """
        host, task = self._simulation.host, self.task
        starts = task.starts(host)
        self._simulation = Simulation(host, task.body_names, starts, "compiled", geoms)
        self._scene = None

    @property
    def host(self) -> Any:
        """The robosuite environment whose model this one steps."""
        return self._simulation.host

    def render(self) -> NDArray[np.uint8]:
        """Return a picture of the whole scene, ``(256, 256, 3)``."""
        return self.render_camera(self.default_camera, PICTURE_SIZE, PICTURE_SIZE)

    def render_camera(self, name: str, height: int, width: int) -> NDArray[np.uint8]:
        """Return a picture, ``(height, width, 3)``; see `Environment`."""
        return self._live((name,), height, width)[name]

    def pictures(
        self, seen: Observations, cameras: Sequence[str], height: int, width: int
    ) -> dict[str, NDArray[np.uint8]]:
        """Return pictures of stored instants, ``(N, height, width, 3)``; see `Environment`."""
        positions = self._simulation.positions_at(seen)
        return self._cameras.pictures(cameras, positions, height, width)

    def close(self) -> None:
        """Free the simulator and what renders; nothing else can be asked afterwards."""
        self._cameras.close()
        self._freed()

    def _moved(self) -> None:
        self._simulation.refresh()
        self._scene = None

    def _read_scene(self) -> Scene:
        simulation = self._simulation
        panda, data = simulation.panda, simulation.data
        position, rotation = panda.gripper_pose(data)
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, rotation.ravel())
        positions, quaternions = simulation.object_poses()
        touches = simulation.touches()
        self._touched = any(left or right for left, right in touches)
        opening = panda.opening(data)
        pairs = zip(self.task.objects, touches, strict=True)
        between = opening > CLOSED_OPENING
        held = [item.name for item, sides in pairs if item.graspable and between and all(sides)]
        return Scene(
            description=self.description,
            gripper_position=position,
            gripper_quaternion=quaternion,
            gripper_opening=opening,
            joint_positions=data.qpos[panda.joint_addresses].copy(),
            objects=ObjectPoses(positions, quaternions, held[0] if held else None),
            gripper_command=self._gripper_command,
        )

    def _observation(self) -> Observation:
        observation: Observation = dict(self.scene().observation())
        if self._images:
            names = tuple(self._images.values())
            images = self._live(names, self._image_size, self._image_size)
            observation.update({key: images[name] for key, name in self._images.items()})
        return observation

    def _live(self, names: Sequence[str], height: int, width: int) -> dict[str, NDArray[np.uint8]]:
        """Return what cameras see now, each ``(height, width, 3)``."""
        now = self._simulation.data.qpos[None]
        found = self._cameras.pictures(names, now, height, width)
        return {name: images[0] for name, images in found.items()}

    def _describe(self) -> SceneDescription:
        task = self.task
        return SceneDescription(
            objects=task.objects,
            workspace_low=task.workspace_low,
            workspace_high=task.workspace_high,
            lift_height=task.lift_height,
            affordances=task.affordances(),
            robot=describe_robot(self._simulation.host, self._simulation.model),
        )

    def _observation_space(self) -> gymnasium.Space[Observation]:
        widths = {
            STATE_KEY: self.description.state_width,
            ENVIRONMENT_STATE_KEY: self.description.environment_state_width,
        }
        spaces: dict[str, gymnasium.Space[Any]] = {
            key: gymnasium.spaces.Box(-np.inf, np.inf, (width,), np.float32)
            for key, width in widths.items()
        }
        shape = (self._image_size, self._image_size, 3)
        for key in self._images:
            spaces[key] = gymnasium.spaces.Box(0, 255, shape, np.uint8)
        return cast(gymnasium.Space[Observation], gymnasium.spaces.Dict(spaces))

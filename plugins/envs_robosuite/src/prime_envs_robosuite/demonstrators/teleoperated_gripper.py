"""How the teleoperated gripper moves: along curves, unevenly, with pauses and noise.

Nothing here knows of primitives or of a planner; a movement is a curve that one might draw with a
device, followed by feedback on the scenes.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import ACTION_LIMIT, CONTROL_FREQUENCY, Action
from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle
from prime_envs_robosuite.demonstrators.motion_curves import (
    arched,
    bent,
    bezier,
    evenly,
    length,
    progress_of,
)
from prime_envs_robosuite.demonstrators.movements import (
    DIRECT,
    OPEN,
    Movement,
    MovementOptions,
)
from prime_envs_robosuite.demonstrators.styles import MotionStyle

Array = NDArray[np.float64]

RESPONSE = 0.265
"""Share of a commanded displacement that the arm covers in the same step, at a steady pace."""

NOISE_MEMORY = 0.85  # correlation of the command noise from step to step
TREMOR = 2e-4  # command noise of a gripper at rest [m]; 5 mm/s would take 1e-3
GRIP = (12, 19)  # steps that are waited for the fingers, from and to below
QUICK_GRIP = (10, 14)  # by those who go on at once; a full stroke takes ten
PATIENCE = 10  # steps of correction at the end of a movement
NEAR = 0.006  # [m], where a movement counts as arrived
NEAR_YAW = 0.05  # [rad]
LOST = 5  # steps without a held object after which the gripper stops
STRAIGHT_BOW = 0.1  # share of their bend that movements keep that must be straight
HESITATION_SHARE = 0.4  # of long movements, of those who do not flow


class TeleoperatedGripper:
    """Moves the gripper in a style.

    Args:
        style: How.
        generator: Where all randomness comes from.

    Attributes:
        style: How.
        command: The gripper's command, `OPEN` or `CLOSE`.
        has_risen: Whether it rose from what it last let go of or pushed.
    """

    def __init__(self, style: MotionStyle, generator: np.random.Generator) -> None:
        self.style = style
        self.command = OPEN
        self.has_risen = True
        self._generator = generator
        # Of its own, so that how much flows changes no other draw.
        self._flow_draws = generator.spawn(1)[0]
        self._noise = np.zeros(4)

    def flows(self) -> bool:
        """Decide whether this movement goes over into the next without a stop."""
        return bool(self._flow_draws.random() < self.style.flow)

    def hesitates(self) -> bool:
        """Decide whether a long movement stops on its way."""
        return bool(self._generator.random() < HESITATION_SHARE) and not self.flows()

    def stays_low(self) -> bool:
        """Decide whether to go on to the next object without rising first."""
        self.has_risen = not self.flows()
        return not self.has_risen

    def options_onward(
        self, scene: Scene, command: float, hesitate: bool = False
    ) -> MovementOptions:
        """Return how to go to the next object: rising first if the gripper has not yet.

        Args:
            scene: The scene now.
            command: The gripper's command that the object needs, given on the way.
            hesitate: As in `MovementOptions`.
        """
        over = None if self.has_risen else scene.description.lift_height
        self.has_risen = True
        return MovementOptions(hesitate, over=over, command=command)

    def pause(self, scene: Scene, scale: float = 1.0) -> Movement:
        """Rest for a while; how long varies.

        Args:
            scene: The scene now.
            scale: Mean length in units of the style's.
        """
        seconds = self._generator.gamma(2.0, scale * self.style.pause / 2.0)
        return (yield from self.wait(scene, 2 + round(seconds * CONTROL_FREQUENCY)))

    def wait(self, scene: Scene, steps: int) -> Movement:
        """Rest for a number of steps."""
        for _ in range(steps):
            scene = yield self._action(np.zeros(4))
        return scene

    def grip(self, scene: Scene, command: float) -> Movement:
        """Open or close the gripper, and wait until it has.

        Args:
            scene: The scene now.
            command: `OPEN` or `CLOSE`.
        """
        self.command = command
        steps = QUICK_GRIP if self.flows() else GRIP
        return (yield from self.wait(scene, int(self._generator.integers(*steps))))

    def move(
        self, scene: Scene, goal: Array, yaw: float, options: MovementOptions = DIRECT
    ) -> Movement:
        """Move along a bent path, first faster, then slower; stop if what is held gets lost.

        Args:
            scene: The scene now.
            goal: Where to [m], world frame, ``(3,)``.
            yaw: To which yaw [rad].
            options: How it goes.
        """
        bow = self.style.bow * (STRAIGHT_BOW if options.straight else 1.0)
        path = bent(scene.gripper_position, goal, bow, self._generator)
        distance = float(np.linalg.norm(goal - scene.gripper_position))
        if options.over is not None:
            path = arched(path, options.over)
            distance = length(path)
        turn = float(wrap_angle(yaw - scene.gripper_yaw))
        start_yaw = scene.gripper_yaw
        progress = progress_of(distance, turn, options.hesitate, self.style, self._generator)
        points = bezier(path, progress if options.over is None else evenly(path, progress))
        yaws = start_yaw + turn * progress
        carried, missing = scene.held, 0
        for step in range(1, len(progress) + (PATIENCE if options.exact else 0)):
            now, last = min(step, len(progress) - 1), min(step - 1, len(progress) - 1)
            missing = missing + 1 if carried and scene.held is None else 0
            if missing >= LOST or (now == last and _arrived(scene, goal, yaw)):
                break
            if options.command is not None and now > len(progress) // 2:
                self.command = options.command
            command = np.append(points[now] - points[last], yaws[now] - yaws[last]) / RESPONSE
            command[:3] += points[last] - scene.gripper_position
            command[3] += wrap_angle(yaws[last] - scene.gripper_yaw)
            scene = yield self._action(command)
        return scene

    def reach(
        self, scene: Scene, goal: Array, yaw: float, options: MovementOptions = DIRECT
    ) -> Movement:
        """Move far: arrive inexactly, pause, and correct, or go on as it is; see `swing`."""
        scene = yield from self.swing(scene, goal, yaw, options)
        if self.flows():
            return scene
        scene = yield from self.pause(scene, 0.6)
        return (yield from self.move(scene, goal, yaw))

    def swing(
        self, scene: Scene, goal: Array, yaw: float, options: MovementOptions = DIRECT
    ) -> Movement:
        """Move far, to somewhere near the goal and a little past it.

        Args:
            scene: The scene now.
            goal: Where to [m], world frame, ``(3,)``.
            yaw: To which yaw [rad].
            options: How it goes.
        """
        style = self.style
        along = goal - scene.gripper_position
        past = style.overshoot * along / max(float(np.linalg.norm(along)), 0.1)
        missed = goal + past + self._generator.normal(0.0, style.aim, 3)
        turned = float(yaw + self._generator.normal(0.0, style.yaw_aim))
        options = replace(options, exact=not self.flows())
        return (yield from self.move(scene, missed, turned, options))

    def _action(self, command: Array) -> Action:
        """Return a motor action: the command (dx, dy, dz, dyaw) with coloured noise, in limits."""
        fresh = self._generator.standard_normal(4)
        self._noise = NOISE_MEMORY * self._noise + np.sqrt(1 - NOISE_MEMORY**2) * fresh
        # A yaw that is commanded like a position is: 0.05 m corresponds to 0.5 rad.
        size = np.repeat((float(np.linalg.norm(command[:3])), abs(float(command[3]))), (3, 1))
        deviation = self.style.noise * size + TREMOR * np.array([1.0, 1.0, 1.0, 2.0])
        action = np.append(command + deviation * self._noise, self.command)
        # Just inside the limits, which float32 would round up.
        limit = ACTION_LIMIT * (1 - 1e-6)
        action[:4] = np.clip(action, -limit, limit)[:4]
        return action


def _arrived(scene: Scene, goal: Array, yaw: float) -> bool:
    near = np.linalg.norm(goal - scene.gripper_position) < NEAR
    return bool(near and abs(wrap_angle(yaw - scene.gripper_yaw)) < NEAR_YAW)

"""How a hand moves that nobody programmed: curved, uneven, with pauses and noise.

Nothing here knows of primitives or of a planner; a movement is a curve that a person might
draw with a device, followed by feedback on the scenes.
"""

from collections.abc import Generator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import ACTION_LIMIT, CONTROL_FREQUENCY, Action
from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle
from prime_envs_robosuite.teleoperator_curves import arched, bezier, evenly, length, smooth_rise

Array = NDArray[np.float64]
Movement = Generator[Action, Scene, Scene]
"""Yields motor actions, is sent the scene after each, and returns the last scene."""

Outcome = Generator[Action, Scene, tuple[Scene, bool]]
"""A movement that also returns whether it did what it was for."""

OPEN, CLOSE = -1.0, 1.0
TRIES = 4  # grasps, fittings or pushes that a person attempts before giving up

RESPONSE = 0.265
"""Share of a commanded displacement that the arm covers in the same step, at a steady pace."""

PEAK_SPEED = 0.24  # [m/s]; the command saturates at 0.05 m, which is 0.265 m/s
REACTION = 0.2  # the part of a movement's duration that does not depend on its length [s]
NOISE_MEMORY = 0.85  # correlation of the command noise from step to step
TREMOR = 2e-4  # command noise of a hand at rest [m]; 5 mm/s would take 1e-3
GRIP = (12, 19)  # steps that are waited for the fingers, from and to below
QUICK_GRIP = (10, 14)  # by those who go on at once; a full stroke takes ten
PATIENCE = 10  # steps of correction at the end of a movement
NEAR = 0.006  # [m], where a movement counts as arrived
NEAR_YAW = 0.05  # [rad]
LOST = 5  # steps without a held object after which the hand stops
STRAIGHT_BOW = 0.1  # share of their bend that movements keep that must be straight


@dataclass(frozen=True)
class Style:
    """How one person moves in one demonstration.

    Attributes:
        speed: Mean speed of a long movement [m/s].
        pause: Mean length of a pause [s].
        bow: How far a movement bends aside, as a share of its length.
        aim: Standard deviation of where a long movement ends [m].
        yaw_aim: Standard deviation of the yaw it ends at [rad].
        overshoot: How far long movements run past their goal [m].
        noise: Command noise as a share of the command.
        hover: Height over the object at which the approach ends [m].
        ramp: Time in which a long movement reaches its speed [s].
        turn_speed: Mean speed of turning [rad/s].
        flow: Share of movements that go over into the next without a stop.
        grip_within: How far from where it should the gripper may close [m].
    """

    speed: float
    pause: float
    bow: float
    aim: float
    yaw_aim: float
    overshoot: float
    noise: float
    hover: float
    ramp: float
    turn_speed: float
    flow: float
    grip_within: float

    def with_care(self, care: float) -> "Style":
        """Return the style with all movements slower and all pauses longer by a factor."""
        return replace(self, speed=self.speed / care, pause=self.pause * care)


@dataclass(frozen=True)
class Way:
    """How one movement goes.

    Attributes:
        hesitate: Whether it stops for a pause.
        straight: Whether the path has to be all but straight.
        over: Height that the path arches up to [m]; None for no arch.
        gripper: What the gripper is commanded half-way; None to leave it as it is.
        exact: Whether it goes on until it has arrived.
    """

    hesitate: bool = False
    straight: bool = False
    over: float | None = None
    gripper: float | None = None
    exact: bool = True


DIRECT = Way()


class Hand:
    """Moves the gripper in a style.

    Args:
        style: How.
        generator: Where all randomness comes from.

    Attributes:
        style: How.
        gripper: The gripper's command, `OPEN` or `CLOSE`.
        has_risen: Whether it rose from what it last let go of or pushed.
    """

    def __init__(self, style: Style, generator: np.random.Generator) -> None:
        self.style = style
        self.gripper = OPEN
        self.has_risen = True
        self._generator = generator
        # Of its own: people who never flow draw what they drew before there was flow.
        self._habits = generator.spawn(1)[0]
        self._noise = np.zeros(4)

    def flows(self) -> bool:
        """Decide whether this movement goes over into the next without a stop."""
        return bool(self._habits.random() < self.style.flow)

    def stays_low(self) -> bool:
        """Decide whether to go on to the next object without rising first."""
        self.has_risen = not self.flows()
        return not self.has_risen

    def way_on(self, scene: Scene, gripper: float, hesitate: bool = False) -> Way:
        """Return the way to the next object, which rises first if the hand has not yet.

        Args:
            scene: The scene now.
            gripper: The command that the object needs, given on the way.
            hesitate: As in `Way`.
        """
        over = None if self.has_risen else scene.description.lift_height
        self.has_risen = True
        return Way(hesitate, over=over, gripper=gripper)

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
        self.gripper = command
        steps = QUICK_GRIP if self.flows() else GRIP
        return (yield from self.wait(scene, int(self._generator.integers(*steps))))

    def move(self, scene: Scene, goal: Array, yaw: float, way: Way = DIRECT) -> Movement:
        """Move along a bent path, first faster, then slower; stop if what is held gets lost.

        Args:
            scene: The scene now.
            goal: Where to [m], world frame, ``(3,)``.
            yaw: To which yaw [rad].
            way: How it goes.
        """
        bow = self.style.bow * (STRAIGHT_BOW if way.straight else 1.0)
        path = self._path(scene.gripper_position, goal, bow)
        distance = float(np.linalg.norm(goal - scene.gripper_position))
        if way.over is not None:
            path = arched(path, way.over)
            distance = length(path)
        turn = float(wrap_angle(yaw - scene.gripper_yaw))
        start_yaw = scene.gripper_yaw
        progress = self._progress(distance, turn, way.hesitate)
        points = bezier(path, progress if way.over is None else evenly(path, progress))
        yaws = start_yaw + turn * progress
        carried, missing = scene.held, 0
        for step in range(1, len(progress) + (PATIENCE if way.exact else 0)):
            now, last = min(step, len(progress) - 1), min(step - 1, len(progress) - 1)
            missing = missing + 1 if carried and scene.held is None else 0
            if missing >= LOST or (now == last and _arrived(scene, goal, yaw)):
                break
            if way.gripper is not None and now > len(progress) // 2:
                self.gripper = way.gripper
            command = np.append(points[now] - points[last], yaws[now] - yaws[last]) / RESPONSE
            command[:3] += points[last] - scene.gripper_position
            command[3] += wrap_angle(yaws[last] - scene.gripper_yaw)
            scene = yield self._action(command)
        return scene

    def reach(self, scene: Scene, goal: Array, yaw: float, way: Way = DIRECT) -> Movement:
        """Move far: arrive inexactly, pause, and correct, or go on as it is; see `swing`."""
        scene = yield from self.swing(scene, goal, yaw, way)
        if self.flows():
            return scene
        scene = yield from self.pause(scene, 0.6)
        return (yield from self.move(scene, goal, yaw))

    def swing(self, scene: Scene, goal: Array, yaw: float, way: Way = DIRECT) -> Movement:
        """Move far, to somewhere near the goal and a little past it.

        Args:
            scene: The scene now.
            goal: Where to [m], world frame, ``(3,)``.
            yaw: To which yaw [rad].
            way: How it goes.
        """
        style = self.style
        along = goal - scene.gripper_position
        past = style.overshoot * along / max(float(np.linalg.norm(along)), 0.1)
        missed = goal + past + self._generator.normal(0.0, style.aim, 3)
        turned = float(yaw + self._generator.normal(0.0, style.yaw_aim))
        way = replace(way, exact=not self.flows())
        return (yield from self.move(scene, missed, turned, way))

    def _path(self, start: Array, goal: Array, bow: float) -> Array:
        """Return the control points ``(4, 3)`` of a curve bent to a side and upwards."""
        way = goal - start
        aside = np.array([-way[1], way[0], 0.0])
        aside /= max(float(np.linalg.norm(aside)), 1e-6)
        bends = self._generator.normal(0.0, bow * float(np.linalg.norm(way)), (2, 2))
        points = np.stack((start, start + way / 3, start + 2 * way / 3, goal))
        points[1:3] += bends[:, :1] * aside
        # Upwards only: below the straight line are the walls of the bins.
        points[1:3, 2] += np.abs(bends[:, 1])
        return points

    def _progress(self, distance: float, turn: float, hesitate: bool) -> Array:
        """Return how much of a movement is done after each step, from 0 to 1, ``(T + 1,)``."""
        seconds = REACTION + max(distance / self.style.speed, abs(turn) / self.style.turn_speed)
        peak = distance / seconds / (1 - min(0.5, self.style.ramp / seconds))
        steps = round(seconds * max(1.0, peak / PEAK_SPEED) * CONTROL_FREQUENCY)
        ramp = self.style.ramp * CONTROL_FREQUENCY
        if not hesitate:
            return smooth_rise(steps, ramp)
        share = float(self._generator.uniform(0.3, 0.7))
        rest = np.full(round(2 * self.style.pause * CONTROL_FREQUENCY), share)
        before = share * smooth_rise(max(2, round(share * steps)), ramp)
        after = share + (1 - share) * smooth_rise(max(2, round((1 - share) * steps)), ramp)
        return np.concatenate((before, rest, after[1:]))

    def _action(self, command: Array) -> Action:
        """Return a motor action: the command (dx, dy, dz, dyaw) with coloured noise, in limits."""
        fresh = self._generator.standard_normal(4)
        self._noise = NOISE_MEMORY * self._noise + np.sqrt(1 - NOISE_MEMORY**2) * fresh
        # A yaw that is commanded like a position is: 0.05 m corresponds to 0.5 rad.
        size = np.repeat((float(np.linalg.norm(command[:3])), abs(float(command[3]))), (3, 1))
        deviation = self.style.noise * size + TREMOR * np.array([1.0, 1.0, 1.0, 2.0])
        action = np.append(command + deviation * self._noise, self.gripper)
        # Just inside the limits, which float32 would round up.
        limit = ACTION_LIMIT * (1 - 1e-6)
        action[:4] = np.clip(action, -limit, limit)[:4]
        return action


def _arrived(scene: Scene, goal: Array, yaw: float) -> bool:
    near = np.linalg.norm(goal - scene.gripper_position) < NEAR
    return bool(near and abs(wrap_angle(yaw - scene.gripper_yaw)) < NEAR_YAW)

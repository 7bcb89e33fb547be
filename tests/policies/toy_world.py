"""A world without physics: a gripper that reaches, grasps and places one carton.

Shared by the tests of the policies. Every call is a few frames long and ends near its target.
"""

from dataclasses import dataclass, field

import numpy as np

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveSpace
from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.observations import Observations
from prime_core.contracts.training import CallData, Labels, ModelContext
from prime_core.rotations import gripper_down, wrap_angle

LOW, HIGH = (-0.1, -0.4, 0.8), (0.3, 0.4, 1.1)
REACH, GRASP, PLACE, OTHER = range(4)
FRAMES_PER_CALL = 6
BIN = np.array([0.1, 0.3, 0.86])

DESCRIPTION = SceneDescription(
    objects=(ObjectDescription("carton", yaw_symmetry=4),),
    workspace_low=LOW,
    workspace_high=HIGH,
    lift_height=1.05,
    joint_count=2,
)
_POSE = ParameterSpace(
    (
        Parameter("x", "m", LOW[0], HIGH[0]),
        Parameter("y", "m", LOW[1], HIGH[1]),
        Parameter("z", "m", LOW[2], HIGH[2]),
        Parameter("yaw", "rad", -np.pi / 2, np.pi / 2, period=np.pi),
    )
)
SPACE = PrimitiveSpace(("reach", "grasp", "place"), (_POSE, _POSE, _POSE))
CONTEXT = ModelContext(description=DESCRIPTION, space=SPACE, device="cpu")


@dataclass
class World:
    """The state, and all frames and calls so far.

    Attributes:
        generator: Of all draws.
        noise: Standard deviation of where a call ends [m].
        calls: Start frame, end frame, primitive, parameters of each call.
    """

    generator: np.random.Generator
    noise: float = 1e-3
    calls: list[tuple[int, int, int, np.ndarray]] = field(default_factory=list)
    _states: list[np.ndarray] = field(default_factory=list)
    _objects: list[np.ndarray] = field(default_factory=list)

    def reset(self) -> None:
        draw = self.generator.uniform
        self.gripper = np.array([draw(-0.05, 0.05), draw(-0.05, 0.05), 1.0])
        self.yaw, self.opening, self.held = draw(-0.3, 0.3), 0.08, False
        self.carton = np.array([draw(0.0, 0.25), draw(-0.35, 0.0), 0.85])
        self.carton_yaw = draw(-np.pi, np.pi)
        self._record()

    def random_call(self) -> None:
        """Do a primitive that makes sense, with parameters from a prior."""
        draw = self.generator
        if draw.random() < 0.5:
            self.call(REACH, draw.uniform(_POSE.low, _POSE.high))
        elif self.held:
            place = np.array([draw.uniform(0, 0.25), draw.uniform(-0.35, 0.35), 0.86])
            self.call(PLACE, np.append(place, draw.uniform(-1.5, 1.5)))
        else:
            self.call(GRASP, self.grasp_target())

    def grasp_target(self) -> np.ndarray:
        """Return parameters of a grasp of the carton, in line with its nearest side."""
        turn = wrap_angle(self.carton_yaw - self.yaw, np.pi / 2)
        yaw = wrap_angle(self.yaw + turn + self.generator.normal(0, 0.03), np.pi)
        position = self.carton + np.array([0, 0, 0.04]) + self.generator.normal(0, 0.003, 3)
        return np.append(position, yaw)

    def call(self, primitive: int, parameters: np.ndarray) -> None:
        start, begin = len(self._states) - 1, self.gripper
        # Where it ends misses the target by an offset that depends on how far it travelled.
        travel = parameters[:3] - begin
        end = parameters[:3] + 0.02 * travel * (primitive + 1)
        end = end + self.generator.normal(0, self.noise, 3)
        self.yaw = wrap_angle(parameters[3] + self.generator.normal(0, 0.01), np.pi)
        for share in np.linspace(0, 1, FRAMES_PER_CALL)[1:]:
            self._move(begin + share * (end - begin))
        self.held = primitive == GRASP or (primitive == REACH and self.held)
        self.opening = 0.05 if self.held else 0.08
        if primitive == PLACE:
            self.carton = np.append(self.carton[:2], 0.85)
        self._record()
        self.calls.append((start, len(self._states) - 1, primitive, parameters))

    def push(self) -> None:
        """Push the carton; the parameters are where behind it that starts, 5 cm from its centre."""
        start, draw = len(self._states) - 1, self.generator.uniform
        angle = draw(-np.pi, np.pi)
        way = np.array([np.cos(angle), np.sin(angle), 0.0])
        begin = self.carton - 0.05 * way
        self.carton = self.carton + draw(0.1, 0.3) * way
        self._move(self.carton + np.array([0.0, 0.0, 0.1]))  # says nothing about the way
        self.calls.append((start, len(self._states) - 1, REACH, np.append(begin, self.yaw)))

    def retreat(self) -> None:
        """Move the empty hand away, up and aside."""
        aside = self.generator.uniform(-0.05, 0.05, 2)
        self._move(self.gripper + np.append(aside, 0.06))

    def observations(self) -> Observations:
        return Observations(np.array(self._states, np.float32), np.array(self._objects, np.float32))

    def _move(self, position: np.ndarray) -> None:
        if self.held:
            self.carton = self.carton + position - self.gripper
        self.gripper = position
        self._record()

    def _record(self) -> None:
        half = self.carton_yaw / 2
        state = [*self.gripper, *gripper_down(self.yaw), self.opening, 0.0, 0.0]
        self._states.append(np.array(state))
        quaternion = [np.cos(half), 0, 0, np.sin(half)]
        self._objects.append(np.array([*self.carton, *quaternion, float(self.held)]))


def rollouts(seed: int, episodes: int, noise: float = 1e-3) -> World:
    """Return a world after random calls, ten in each episode."""
    world = World(np.random.default_rng(seed), noise)
    for _ in range(episodes):
        world.reset()
        for _ in range(10):
            world.random_call()
    return world


def pushes(seed: int, count: int) -> World:
    """Return a world after pushes, one in each episode."""
    world = World(np.random.default_rng(seed))
    for _ in range(count):
        world.reset()
        world.push()
    return world


def places_with_retreats(seed: int, count: int) -> World:
    """Return a world after places; every other one is told from after the hand's retreat."""
    world = World(np.random.default_rng(seed))
    for number in range(count):
        world.reset()
        world.call(GRASP, world.grasp_target())
        goal = np.array(
            [world.generator.uniform(0, 0.25), world.generator.uniform(-0.3, 0.3), 0.88]
        )
        world.call(PLACE, np.append(goal, world.generator.uniform(-1.0, 1.0)))
        start, end, primitive, parameters = world.calls.pop()
        world.calls.pop()
        if number % 2:
            end += 2
            for _ in range(2):
                world.retreat()
        world.calls.append((start, end, primitive, parameters))
    return world


def demonstrations(seed: int, episodes: int) -> World:
    """Return a world after grasping the carton and placing it in the bin, in each episode."""
    world = World(np.random.default_rng(seed))
    for _ in range(episodes):
        world.reset()
        world.call(GRASP, world.grasp_target())
        place = BIN + world.generator.normal(0, 0.005, 3)
        world.call(PLACE, np.append(place, world.generator.normal(0, 0.05)))
    return world


def pair_data(world: World) -> CallData:
    """Return what an inverse dynamics model learns from the calls of a world."""
    pairs, labels, parameters = _calls(world)
    seen = world.observations()
    starts = world.generator.integers(0, len(seen) - 60, len(pairs))
    others = np.stack((starts, starts + world.generator.integers(5, 60, len(pairs))), axis=1)
    weights = 1.0 / np.bincount(labels, minlength=3)[labels]
    return CallData(
        observations=seen,
        types=Labels(
            rows=np.concatenate((pairs, others)),
            classes=np.concatenate((labels, np.full(len(others), OTHER))),
            weights=np.concatenate((weights, np.full(len(others), 1.0 / len(others)))),
        ),
        parameters=Labels(pairs, labels, weights),
        values=parameters,
    )


def policy_data(world: World, augmented: bool = False) -> CallData:
    """Return what a policy learns: the call to make at each call's start.

    Args:
        world: What was done.
        augmented: Whether the frames on the way are examples too.
    """
    pairs, classes, parameters = _calls(world)
    count = FRAMES_PER_CALL - 1 if augmented else 1
    rows = (pairs[:, :1] + np.arange(count)).reshape(-1, 1)
    labels = Labels(rows, classes.repeat(count), np.ones(len(rows)))
    return CallData(world.observations(), labels, labels, parameters.repeat(count, axis=0))


def _calls(world: World) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    starts, ends, labels, parameters = zip(*world.calls, strict=True)
    return np.stack((starts, ends), axis=1), np.array(labels), np.array(parameters)

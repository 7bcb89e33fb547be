"""A simulated robot behind LeRobot's robot interface, in a process of its own and in real time.

It stands in for a lab's own robot: what `robot_loop.py` does with it, it does with any. Frames come
late by up to a jitter, and some never come. A tick without an action holds still.
"""

import multiprocessing
import tempfile
import time
from collections import deque
from dataclasses import dataclass, field
from functools import cached_property
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from lerobot.robots import Robot, RobotConfig

from prime_core import Environment, EnvironmentConfig, Observations, SceneDescription
from prime_core.contracts.environment import ACTION_NAMES
from prime_core.registry.fields import read_settings

LONGEST_START = 120.0
"""Until the simulation is built and shows its first frame [s]."""


@RobotConfig.register_subclass("prime_simulated")
@dataclass(kw_only=True)
class SimulatedRobotConfig(RobotConfig):
    """Settings of the robot.

    Attributes:
        environment: Settings of the environment that is simulated, with their ``type``.
        description: Of its scenes: the names of what is measured.
        views: Cameras that it has, by their names.
        size: Height and width of an image [pixels].
        rate: Ticks a second [Hz]: an action, a frame.
        jitter: By which a frame is late at most [s].
        missing: Share of the frames that never come.
        delay: Ticks by which each action is late.
        seed: Of jitter and missing frames.
    """

    environment: dict[str, Any]
    description: SceneDescription
    views: tuple[str, ...] = ()
    size: int = 84
    rate: int = 20
    jitter: float = 0.0
    missing: float = 0.0
    delay: int = 0
    seed: int = 0
    calibration_dir: Path | None = field(default_factory=lambda: Path(tempfile.mkdtemp()))


class SimulatedRobot(Robot):
    """A robot that is simulated elsewhere: this end only sends actions and receives frames.

    Attributes:
        made: When the newest frame was made, by `time.perf_counter`.
        solved: Whether the task was solved then; a lab's own robot does not know.
    """

    config_class = SimulatedRobotConfig
    name = "prime_simulated"

    def __init__(self, config: SimulatedRobotConfig) -> None:
        super().__init__(config)
        self.config = config
        self.made, self.solved = 0.0, False
        self._process: Any = None
        self._pipe: Connection | None = None

    @cached_property
    def observation_features(self) -> dict[str, Any]:
        """The robot's state, object poses of the lab's estimator, images."""
        description, size = self.config.description, self.config.size
        numbers = [*description.state_names, *description.environment_state_names]
        return dict.fromkeys(numbers, float) | dict.fromkeys(self.config.views, (size, size, 3))

    @cached_property
    def action_features(self) -> dict[str, Any]:
        """A motor action of prime's."""
        return dict.fromkeys(ACTION_NAMES, float)

    @property
    def is_connected(self) -> bool:
        """Whether the simulation runs."""
        return self._process is not None and self._process.is_alive()

    @property
    def is_calibrated(self) -> bool:
        """There is nothing to calibrate."""
        return True

    def calibrate(self) -> None:
        """Do nothing."""

    def configure(self) -> None:
        """Do nothing."""

    def connect(self, calibrate: bool = True) -> None:
        """Start the simulation."""
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_simulate, args=(self.config, theirs), daemon=True)
        self._process.start()
        theirs.close()

    def begin(self, seed: int) -> None:
        """Put everything where an episode begins; a person does that for a lab's own robot."""
        assert self._pipe is not None, "connect() comes first"
        self._pipe.send(seed)
        deadline = time.perf_counter() + LONGEST_START
        while not (self._pipe.poll(1.0) and self._pipe.recv() is None):  # older frames
            if time.perf_counter() > deadline or not self.is_connected:
                raise RuntimeError("the simulation has not begun")

    def get_observation(self) -> dict[str, Any]:
        """Return the newest frame, once.

        Raises:
            TimeoutError: If none has come for one tick and a half: it is missing.
        """
        assert self._pipe is not None, "connect() comes first"
        if not self._pipe.poll(1.5 / self.config.rate):
            raise TimeoutError("the frame is missing")
        while self._pipe.poll():
            frame = self._pipe.recv()
        self.made, self.solved, values = frame
        return dict(values)

    def send_action(self, action: dict[str, Any]) -> dict[str, Any]:
        """Have an action done in the next tick."""
        assert self._pipe is not None, "connect() comes first"
        self._pipe.send(np.array([action[name] for name in ACTION_NAMES]))
        return action

    def disconnect(self) -> None:
        """End the simulation."""
        if self._pipe is not None:
            self._pipe.close()
            self._process.join(10)
            self._pipe = None


def _simulate(config: SimulatedRobotConfig, pipe: Connection) -> None:
    """Step the environment in real time until the other end is closed."""
    environment = read_settings(EnvironmentConfig, config.environment).build()
    generator, observation = np.random.default_rng(config.seed), None
    tick = time.perf_counter()
    try:
        while True:
            came = None
            while pipe.poll(None if observation is None else 0):
                command = pipe.recv()
                if isinstance(command, int):
                    observation, _ = environment.reset(seed=command)
                    came, solved, gripper = None, False, -1.0
                    under_way: deque[Any] = deque([None] * config.delay)
                    _values(environment, observation, config)  # the first images take seconds
                    pipe.send(None)
                else:
                    came = command
            under_way.append(came)
            action = under_way.popleft()
            if action is None:
                action = np.array([0.0, 0.0, 0.0, 0.0, gripper])  # hold still
            gripper = action[4]
            observation, _, now_solved, _, _ = environment.step(action)
            solved = solved or bool(now_solved)
            late = generator.uniform(0.0, config.jitter)
            values = _values(environment, observation, config)
            begun = time.perf_counter()
            time.sleep(late)
            if generator.random() >= config.missing:
                pipe.send((begun, solved, values))
            # Where it cannot keep up, it is slower: each frame has its whole tick.
            tick = max(tick, begun - 1 / config.rate) + 1 / config.rate
            time.sleep(max(0.0, tick - time.perf_counter()))
    except (EOFError, OSError):
        return


def _values(
    environment: Environment, observation: dict[str, Any], config: SimulatedRobotConfig
) -> dict[str, Any]:
    description = config.description
    names = [*description.state_names, *description.environment_state_names]
    parts = observation["observation.state"], observation["observation.environment_state"]
    values: dict[str, Any] = dict(zip(names, np.concatenate(parts).tolist(), strict=True))
    if config.views:
        size, seen = config.size, Observations.single(observation)
        pictures = environment.pictures(seen, config.views, size, size)
        values |= {name: pictures[name][0] for name in config.views}
    return values

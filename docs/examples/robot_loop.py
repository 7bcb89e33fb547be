"""A complete control loop: an exported policy moves a robot behind LeRobot's robot interface.

    prime export-policy runs/lift-quick --out exported
    python docs/examples/robot_loop.py exported --episodes 10

The robot is simulated, in a process of its own and in real time (`simulated_robot.py`); frames are
late and missing, as on a lab's own. For that one, replace `simulated` and `begin`.
"""

import argparse
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from simulated_robot import SimulatedRobot, SimulatedRobotConfig

from prime_core import PolicyRunner
from prime_core.contracts.environment import ACTION_NAMES

IMAGES = "observation.images."


@dataclass
class Episode:
    """What happened in an episode.

    Attributes:
        solved: Whether the task was solved.
        held: Ticks without a frame, in which the robot held still.
        acting: How long the policy took for each action [s].
        answering: From when each frame was made until its action was sent [s].
    """

    solved: bool = False
    held: int = 0
    acting: list[float] = field(default_factory=list)
    answering: list[float] = field(default_factory=list)


def run_episode(robot: SimulatedRobot, runner: PolicyRunner, seed: int, limit: int) -> Episode:
    """Let the policy move the robot until the task is solved, it gives up, or the limit is reached.

    Args:
        robot: Connected; where the episode begins.
        runner: Loaded.
        seed: Of the policy's random draws.
        limit: Actions at most.
    """
    episode, told = Episode(), 0
    runner.reset(seed)
    while runner.steps < limit:
        try:
            named = robot.get_observation()
        except TimeoutError:
            # What was seen last is all that is known, and it is old: hold still until the next.
            episode.held += 1
            robot.send_action(named_action(runner.hold()))
            continue
        if robot.solved:
            episode.solved = True
            break
        begin = time.perf_counter()
        action = runner.act(observation_of(named, runner))
        episode.acting.append(time.perf_counter() - begin)
        if action is None:
            break
        robot.send_action(named_action(action))
        episode.answering.append(time.perf_counter() - robot.made)
        ended = runner.trace[:-1]
        for record in ended[told:]:
            print(f"  {record}")
        told = len(ended)
    for record in runner.trace[told:]:
        print(f"  {record}")
    return episode


def observation_of(named: Mapping[str, Any], runner: PolicyRunner) -> dict[str, Any]:
    """Return what the policy looks at, by LeRobot's keys, from what LeRobot's robot measures."""
    description = runner.models.description
    vectors = {
        "observation.state": description.state_names,
        "observation.environment_state": description.environment_state_names,
    }
    return {
        key: named[key.removeprefix(IMAGES)]
        if key.startswith(IMAGES)
        else np.array([named[name] for name in vectors[key]])
        for key in runner.keys
    }


def named_action(action: np.ndarray[Any, Any]) -> dict[str, float]:
    """Return a motor action by LeRobot's names."""
    return dict(zip(ACTION_NAMES, action.tolist(), strict=True))


def simulated(runner: PolicyRunner, **troubles: Any) -> SimulatedRobot:
    """Return the robot that the policy was trained for, simulated, with jitter and the like."""
    manifest = runner.models.manifest
    views = tuple(key.removeprefix(IMAGES) for key in runner.keys if key.startswith(IMAGES))
    config = SimulatedRobotConfig(
        id="simulated",
        environment=manifest.origin.environment,
        description=runner.models.description,
        views=views,
        size=84 if manifest.cameras is None else manifest.cameras.size,
        rate=runner.rate,
        **troubles,
    )
    return SimulatedRobot(config)


def main() -> None:
    """Run episodes, and print how each went and how long an answer took."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="What 'prime export-policy' wrote.")
    parser.add_argument("--episodes", type=int, default=5)
    parser.add_argument("--limit", type=int, help="Actions of an episode; the run's if not given.")
    parser.add_argument("--jitter", type=float, default=0.01, help="Of a frame, in seconds.")
    parser.add_argument("--missing", type=float, default=0.1, help="Share of the frames.")
    parser.add_argument("--delay", type=int, default=0, help="Of an action, in ticks.")
    options = parser.parse_args()
    runner = PolicyRunner.load(options.folder)
    limit = options.limit or runner.models.manifest.origin.maximum_steps
    troubles = {"jitter": options.jitter, "missing": options.missing, "delay": options.delay}
    robot = simulated(runner, **troubles)
    robot.connect()
    episodes = []
    try:
        for seed in range(options.episodes):
            robot.begin(seed)
            episode = run_episode(robot, runner, seed, limit)
            episodes.append(episode)
            print(
                f"episode {seed}: {'solved' if episode.solved else 'not solved'} after "
                f"{runner.steps} actions, {episode.held} ticks without a frame",
                flush=True,
            )
    finally:
        robot.disconnect()
    print(f"{sum(each.solved for each in episodes)} of {len(episodes)} solved")
    for what in ("acting", "answering"):
        times = 1000 * np.concatenate([getattr(each, what) for each in episodes])
        middle, most = np.percentile(times, [50, 99])
        print(
            f"{what}: median {middle:.1f} ms, 99 % below {most:.1f} ms, {times.max():.1f} at most"
        )


if __name__ == "__main__":
    main()

"""What a step of an exported policy costs: `PolicyRunner.act`, one thread, processor time.

Apart from the others are steps in which a call of a primitive is chosen: the policy is asked, and
the arm's reach is looked at. Making the images is not counted; a camera does that on a robot.

    OMP_NUM_THREADS=1 python benchmarks/policy_runner.py EXPORTED [EXPORTED ...] [--episodes 5]
"""

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np

from prime_core.contracts.environment import Environment, EnvironmentConfig
from prime_core.contracts.observations import IMAGE_PREFIX, Observations
from prime_core.deployment.policy_runner import PolicyRunner
from prime_core.registry.fields import read_settings


def main() -> None:
    """Print the median, the 99th percentile and the most for each folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", type=Path, nargs="+", metavar="EXPORTED")
    parser.add_argument("--episodes", type=int, default=5)
    options = parser.parse_args()
    for folder in options.folders:
        runner = PolicyRunner.load(folder, device="cpu")
        settings = runner.models.manifest.origin.environment
        environment = read_settings(EnvironmentConfig, settings).build()
        usual, choosing = [], []
        for seed in range(options.episodes):
            for seconds, is_choice in episode(runner, environment, seed):
                (choosing if is_choice else usual).append(1000 * seconds)
        print(f"{folder}: looks at {', '.join(runner.keys)}")
        for what, times in (("usual steps", usual), ("steps that choose a call", choosing)):
            if times:
                middle, most = np.percentile(times, [50, 99])
                print(
                    f"  {len(times)} {what}: median {middle:.2f} ms, 99 % below {most:.2f} ms, "
                    f"{max(times):.2f} ms at most",
                    flush=True,
                )


def episode(runner: PolicyRunner, environment: Environment, seed: int) -> list[tuple[float, bool]]:
    """Return the processor time of each step [s], and whether a call was chosen in it."""
    observation, _ = environment.reset(seed=seed)
    runner.reset(seed)
    found, solved = [], False
    while len(found) < runner.models.manifest.origin.maximum_steps and not solved:
        shown = with_images(runner, environment, observation)
        calls, begin = len(runner.trace), time.process_time()
        action = runner.act(shown)
        seconds = time.process_time() - begin
        found.append((seconds, len(runner.trace) > calls))
        if action is None:
            break
        observation, _, solved, _, _ = environment.step(action)
    return found


def with_images(
    runner: PolicyRunner, environment: Environment, observation: dict[str, Any]
) -> dict[str, Any]:
    """Return an observation with the images that the policy looks at."""
    names = [key.removeprefix(IMAGE_PREFIX) for key in runner.keys if key.startswith(IMAGE_PREFIX)]
    cameras = runner.models.manifest.cameras
    if not names or cameras is None:
        return observation
    seen = Observations.single(observation)
    pictures = environment.pictures(seen, names, cameras.size, cameras.size)
    return observation | {IMAGE_PREFIX + name: each[0] for name, each in pictures.items()}


if __name__ == "__main__":
    main()

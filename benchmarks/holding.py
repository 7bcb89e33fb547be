"""How often what the gripper tells of holding something agrees with the contacts in the simulator.

    python benchmarks/holding.py --episodes 40

In scenes without objects, holding is told from the gripper's last command and its fingers. Episodes
of the collection are run in every task; of the frames of their rollouts, and of the frames where
primitives start, it prints the share in which both say the same.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from prime_core.collection.episode import Collector
from prime_core.contracts.observations import Observations
from prime_core.contracts.scene import Scene
from prime_core.execution.world import World
from prime_core.experiments.reading import read_experiment
from prime_core.seeds import Stream, generator_of

ROOT = Path(__file__).parents[1]
TASKS = ("lift", "pick_place", "nut_assembly", "tidy_up", "clean_up_bin", "clean_up_stack")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--episodes", type=int, default=40, help="of each task")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    print("| task | frames of rollouts | agree | starts of primitives | agree |")
    print("|---|---|---|---|---|")
    for task in TASKS:
        inside, starts = agreement(task, arguments.episodes, arguments.seed)
        print(
            f"| {task} | {len(inside)} | {inside.mean():.3f} | {len(starts)} "
            f"| {starts.mean():.3f} |",
            flush=True,
        )


def agreement(task: str, episodes: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return whether both agree in each frame of rollouts, and in each frame where one starts."""
    config = read_experiment(ROOT / "experiments" / f"{task}.yaml")
    environment = config.environment.build()
    primitives = tuple(item.build(environment.description) for item in config.primitives)
    collector = Collector(World(environment, primitives), config.collection)
    inside: list[bool] = []
    starts: list[bool] = []
    for number in range(episodes):
        episode, _ = collector.collect(generator_of(Stream.COLLECTION, seed, number))
        seen = Observations(episode.state, episode.environment_state)
        for start, end, _ in episode.rollouts:
            agree = [
                told(environment, seen, episode.actions, row) == bool(seen.held[row].any())
                for row in range(max(start, 1), end + 1)
            ]
            inside += agree
            starts += agree[:1]
    return np.array(inside), np.array(starts)


def told(environment: object, seen: Observations, actions: np.ndarray, row: int) -> bool:
    """Return what the gripper tells in a frame after the first."""
    alone = seen[row : row + 1].only(("proprioception",))
    before = float(seen.gripper_opening[row - 1])
    return Scene.read(environment.description, alone, float(actions[row - 1, 4]), before).holding


if __name__ == "__main__":
    main()

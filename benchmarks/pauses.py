"""How demonstrations pause, and what that leaves of a plan that is the median of each step.

    python benchmarks/pauses.py experiments/paper/pick_place.yaml --set seed=101

How long somebody pauses cannot be told from what is seen. A loss of absolute errors, such as ACT's,
leads to the median of each step of a plan; that a step is a pause in most demonstrations is enough
for the plan to pause there. Ways are those of commands, from an episode's start and from the first
step that closes the gripper.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from prime_core.arrays import Floats
from prime_core.experiments.reading import read_experiment

STILL, MOVING = 1e-3, 1e-2
"""Of a step [m]: at most, and at least."""
PLANS = (20, 50, 100)
"""Steps of plans."""


def main() -> None:
    """Print the figures and the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("experiment", type=Path)
    parser.add_argument("--set", action="append", default=[], dest="settings")
    options = parser.parse_args()
    config = read_experiment(options.experiment, options.settings)
    numbers = range(config.demonstrations.count_available())
    shown = config.demonstrations.demonstrations(config.environment, [*numbers], config.seed)
    actions = [one.actions[:-1] for one in shown]
    steps = np.concatenate([np.linalg.norm(one[:, :3], axis=1) for one in actions])
    print(f"{len(actions)} demonstrations of {len(steps) / len(actions):.0f} steps;", end=" ")
    print(f"{np.mean(steps < STILL):.2f} of the steps are shorter than {1000 * STILL:.0f} mm\n")
    print("| from | steps until it moves, median | of | way of the medians / shown [mm] |")
    print("|---|---|---|---|")
    for name, starts in (
        ("start", [0] * len(actions)),
        ("closing", [int(np.argmax(one[:, 4] > 0)) for one in actions]),
    ):
        parts = [one[start:, :3] for one, start in zip(actions, starts, strict=True)]
        waits = [np.argmax(np.linalg.norm(part, axis=1) > MOVING) for part in parts]
        for count in PLANS:
            median, mean = ways(parts, count)
            print(f"| {name} | {np.median(waits):.0f} | {count} | {median:.0f} / {mean:.0f} |")


def ways(parts: Sequence[Floats], count: int) -> tuple[float, float]:
    """Return the way of each step's median length, and the mean way, of parts that are so long."""
    lengths = [np.linalg.norm(part[:count], axis=1) for part in parts if len(part) >= count]
    medians = np.median(lengths, axis=0)
    return 1000 * float(medians.sum()), 1000 * float(np.sum(lengths, axis=1).mean())


if __name__ == "__main__":
    main()

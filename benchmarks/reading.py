"""How long data sets take to be read, by their number of episodes.

    python benchmarks/reading.py --episodes 1000 4000 --frames 100

Episodes are the first frames of one simulated demonstration of Lift, written as a LeRobot data set
into a temporary folder. Seconds by the clock, of all that `prime parse` reads before it parses.
"""

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from prime_core.contracts.demonstration import Demonstration, DemonstrationError
from prime_core.datasets.read import read_demonstrations
from prime_core.datasets.write import write_dataset
from prime_core.experiments.reading import read_experiment

QUICK = Path(__file__).parents[1] / "experiments" / "lift_quick.yaml"


def episode(frames: int) -> Demonstration:
    """Return a demonstration's first frames."""
    config = read_experiment(QUICK)
    shown = config.demonstrations.demonstrate(config.environment, 0, config.seed)
    states = shown.simulator_states
    return replace(
        shown,
        observations=shown.observations[:frames],
        actions=shown.actions[:frames],
        simulator_states=None if states is None else states[:frames],
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--episodes", type=int, nargs="+", default=[1000, 4000])
    parser.add_argument("--frames", type=int, default=100)
    arguments = parser.parse_args()
    description = read_experiment(QUICK).environment.build().description
    shown = episode(arguments.frames)
    print("| episodes | frames | seconds | milliseconds an episode |")
    print("|---|---|---|---|")
    with tempfile.TemporaryDirectory() as parent:
        for count in arguments.episodes:
            folder = Path(parent) / str(count)
            write_dataset(folder, [shown] * count, description)
            start = time.perf_counter()
            read = list(read_demonstrations(folder, description))
            seconds = time.perf_counter() - start
            assert not any(isinstance(item, DemonstrationError) for item in read)
            frames = sum(len(item.actions) for item in read if isinstance(item, Demonstration))
            print(f"| {len(read)} | {frames} | {seconds:.2f} | {1e3 * seconds / len(read):.2f} |")


if __name__ == "__main__":
    main()

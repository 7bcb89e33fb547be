"""How long a data set takes to be annotated, and whether confidences tell right from wrong.

    python benchmarks/annotate.py RUN DATASET

RUN is the folder of a run, or of exported models; DATASET a LeRobot data set of the same
environment, of which a copy is annotated. Seconds are given by the clock and of the processor (one
thread). Where the data set has segments of the run's own already, those that differ are counted.

    python benchmarks/annotate.py RUN --rollouts 250

Held-out rollouts of the run's collection, three after another, are parsed like demonstrations.
What was really done in them is known. A segment is right if its primitive was at work in half of
its motor actions. The chance that is printed is that of a right one to be surer than a wrong one.
"""

import argparse
import os
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from prime_core.contracts.calls import OTHER
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.observations import Observations
from prime_core.datasets.read import read_dataset
from prime_core.experiments.annotate_dataset import annotate_dataset, model_of_run
from prime_core.experiments.parse_dataset import open_run
from prime_core.parsing.demonstrations import parse_demonstration

TOGETHER = 3  # rollouts in a demonstration
SHORTEST, LONGEST = 30, 450  # motor actions of one


class Clock:
    """Prints what has passed since it was asked last."""

    def __init__(self) -> None:
        self._last = (time.perf_counter(), time.process_time())

    def say(self, what: str) -> None:
        """Print a line."""
        now = (time.perf_counter(), time.process_time())
        wall, processor = (new - old for new, old in zip(now, self._last, strict=True))
        print(f"| {what} | {wall:.2f} | {processor:.2f} |")
        self._last = now


def annotated(run: Path, dataset: Path) -> None:
    """Annotate a copy of a data set, and print what that took."""
    print("| what | seconds | of the processor |\n|---|---|---|")
    clock = Clock()
    model = model_of_run(run)
    clock.say("the models are loaded")
    shown = read_dataset(dataset, model.description, fps=None)
    clock.say("the data set is read")
    segments = []
    for item in shown.demonstrations:
        bare = replace(item, observations=replace(item.observations, images={}))
        segments.append(parse_demonstration(bare, model.idm, model.parser).segments)
    clock.say("parsed")
    with tempfile.TemporaryDirectory() as folder:
        annotate_dataset(dataset, run, Path(folder) / "annotated")
        clock.say("all of it once more, and written")
    steps = np.mean([item.steps for item in shown.demonstrations])
    print(f"{len(segments)} demonstrations of {steps:.0f} steps; load {os.getloadavg()[0]:.1f}")
    if shown.segments is not None:
        places = [
            [[(part.start, part.end, part.call.primitive) for part in items] for items in parsed]
            for parsed in (segments, shown.segments)
        ]
        differing = sum(left != right for left, right in zip(*places, strict=True))
        print(f"{differing} of them are cut in another way than in the data set")


def rehearsals(run: Path, most: int) -> Iterator[tuple[Demonstration, list[str]]]:
    """Yield held-out rollouts after one another, and what was done in each step of them."""
    experiment = open_run(run)
    collection = experiment.collection
    names = experiment.idm.load().space.names
    count = 0
    for episode in collection.episodes(collection.first_held_out, None):
        true = np.full(len(episode.state), len(names))
        for start, end, primitive in episode.rollouts:
            true[start:end] = primitive
        for first in range(0, len(episode.rollouts), TOGETHER):
            chosen = episode.rollouts[first : first + TOGETHER]
            start, end = int(chosen[0, 0]), int(chosen[-1, 1])
            if not SHORTEST <= end - start <= LONGEST or count == most:
                continue
            rows = slice(start, end + 1)
            seen = Observations(episode.state[rows], episode.environment_state[rows])
            count += 1
            yield (
                Demonstration(seen, episode.actions[rows], "rehearse"),
                [(*names, OTHER)[label] for label in true[start:end]],
            )


def told_apart(run: Path, most: int) -> None:
    """Print how well confidences tell right segments from wrong ones."""
    model = model_of_run(run)
    found: list[tuple[str, bool, float]] = []
    for demonstration, true in rehearsals(run, most):
        for item in parse_demonstration(demonstration, model.idm, model.parser).segments:
            assert item.confidence is not None
            share = np.mean([name == item.call.primitive for name in true[item.start : item.end]])
            found.append((item.call.primitive, bool(share >= 0.5), item.confidence))
    print("| primitive | right | median | wrong | median | chance |\n|---|---|---|---|---|---|")
    for name in ("all", *dict.fromkeys(name for name, _, _ in found)):
        right, wrong = (
            np.array([sure for one, so, sure in found if so == truth and name in ("all", one)])
            for truth in (True, False)
        )
        if len(right) and len(wrong):
            chance = (right[:, None] > wrong).mean() + (right[:, None] == wrong).mean() / 2
            medians = [f"{len(part)} | {np.median(part):.2f}" for part in (right, wrong)]
            print(f"| {name} | {' | '.join(medians)} | {chance:.2f} |")


def main() -> None:
    """Print one of the two tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("dataset", type=Path, nargs="?")
    parser.add_argument("--rollouts", type=int, default=250)
    arguments = parser.parse_args()
    if arguments.dataset is None:
        told_apart(arguments.run, arguments.rollouts)
    else:
        annotated(arguments.run, arguments.dataset)


if __name__ == "__main__":
    main()

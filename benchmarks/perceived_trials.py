"""What a policy of images took for the scene in the trials that it failed.

They are run again. At each call it prints how far from the truth each object was told to be. With a
sheet, each row is a call: the scene as it was, and with its objects where they were told to be.

    MUJOCO_GL=egl python benchmarks/perceived_trials.py RUN [--trials N] [--sheet FILE]
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, Observations
from prime_core.contracts.policy import PrimitivePolicy
from prime_core.execution.runner import PrimitiveRunner
from prime_core.execution.trial import Trial, run_trial
from prime_core.execution.world import World
from prime_core.experiments.parse_dataset import open_run
from prime_core.experiments.stages.evaluation import STREAMS, Evaluation
from prime_core.experiments.stages.primitive_policy import PrimitivePolicyTraining
from prime_core.learning.perceived import SEES
from prime_core.seeds import generator_of

SIZE = 168  # pixels, of a picture of the sheet


@dataclass
class Look:
    """What was told at a call, and what was true."""

    told: Observations
    true: Observations


class Watched(PrimitivePolicy):
    """A policy behind a perception, with a note of what it was told at each call."""

    sees = SEES

    def __init__(self, training: PrimitivePolicyTraining, checkpoint: Path, world: World) -> None:
        perception = training.load_perception()
        if perception is None:
            raise SystemExit("this policy gets its poses from the simulator")
        self.cameras, self._perception, self._world = perception.cameras, perception, world
        self._policy = training.config.load(checkpoint, training.context(world))
        self.looks: list[Look] = []

    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Note what is told, and yield calls."""
        told = self._perception.see(seen)
        poses = self._world.environment.scene().observation()[ENVIRONMENT_STATE_KEY]
        true = replace(told, environment_state=np.asarray(poses, np.float32)[None])
        self.looks.append(Look(told, true))
        yield from self._policy.candidates(told, startable, generator)


def main(run: Path, name: str, limit: int, sheet: Path | None) -> None:
    evaluation = open_run(run).evaluations[name]
    training = evaluation.training
    if not isinstance(training, PrimitivePolicyTraining):
        raise SystemExit(f"{name} makes no calls")
    world, rows = training.build_world(), []
    objects = [item.name for item in world.description.objects]
    for seed, number in _failed(evaluation)[:limit]:
        policy = Watched(training, training.checkpoints(seed)[-1], world)
        trial = _again(evaluation, world, policy, seed, number)
        print(f"seed {seed}, fresh trial {number}: {trial.steps} steps, solved: {trial.success}")
        for call, completed, look in zip(trial.calls, trial.completed, policy.looks, strict=False):
            miss = look.told.object_positions[0] - look.true.object_positions[0]
            lengths = np.linalg.norm(miss, axis=-1) * 1e3
            misses = ", ".join(
                f"{item} {length:.0f} mm" for item, length in zip(objects, lengths, strict=True)
            )
            print(f"  {call.primitive}{'' if completed else ' (failed)'}: {misses} off")
            rows.append(_pictures(world, look))
    if sheet is not None and rows:
        Image.fromarray(np.concatenate(rows)).save(sheet)


def _failed(evaluation: Evaluation) -> list[tuple[str, int]]:
    """Return seed and number of the fresh trials that were not solved."""
    fresh = evaluation.trials().get("fresh", {})
    return [
        (seed, number)
        for seed, numbered in fresh.items()
        for trials in numbered.values()
        for number, trial in enumerate(trials)
        if not trial["success"]
    ]


def _again(
    evaluation: Evaluation, world: World, policy: PrimitivePolicy, seed: str, number: int
) -> Trial:
    config = evaluation.config
    runner = PrimitiveRunner(policy, world.primitives, world.description, config.runner)
    generator = generator_of(STREAMS["fresh"], config.seed, int(seed), number)
    return run_trial(world.environment, world.primitives, runner, generator, config.maximum_steps)


def _pictures(world: World, look: Look) -> NDArray[np.uint8]:
    """Return each camera's picture of the scene as it was, and as it was told, in a row."""
    cameras = ("agentview", "wrist")
    shown = [
        world.environment.pictures(seen, cameras, SIZE, SIZE)[name][0]
        for name in cameras
        for seen in (look.true, look.told)
    ]
    return np.concatenate(shown, axis=1)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("--policy", default="prime")
    parser.add_argument("--trials", type=int, default=20)
    parser.add_argument("--sheet", type=Path)
    given = parser.parse_args()
    main(given.run, given.policy, given.trials, given.sheet)

"""How often learned primitives succeed, beside scripted ones from the same states.

    prime learn-primitives runs/lift/dataset --out primitives/lift
    python benchmarks/learned_primitives.py experiments/lift.yaml primitives/lift --proposals 100

Each primitive starts after a reset, or where a scripted grasp has just succeeded if it starts with
something held. Proposals are draws of the scripted primitive's prior that its arm can reach. Both
are judged by the learned primitive's criterion, which looks at no phases of a scripted motion.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from prime_core.arrays import Array
from prime_core.contracts.environment import Environment
from prime_core.contracts.primitive import Primitive
from prime_core.execution.motions import run_primitive, settle
from prime_core.experiments.reading import read_experiment
from prime_core.registry.fields import read_settings
from prime_primitives_learned.config import LearnedConfig

ATTEMPTS = 20  # draws of a prior until one is reachable


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("experiment", type=Path, help="whose environment and scripted primitives")
    parser.add_argument("folder", type=Path, help="what 'prime learn-primitives' wrote")
    parser.add_argument("--proposals", type=int, default=100, help="for each primitive")
    parser.add_argument("--seed", type=int, default=7000, help="of the first reset")
    arguments = parser.parse_args()
    config = read_experiment(arguments.experiment)
    environment = config.environment.build()
    scripted = [item.build(environment.description) for item in config.primitives]
    by_name = {item.name: item for item in scripted}
    print("| primitive | scripted | learned | steps, scripted / learned |")
    print("|---|---|---|---|")
    for folder in sorted(arguments.folder.iterdir()):
        if folder.name in by_name:
            settings = {"type": f"learned/{folder.name}", "trained": folder}
            learned = read_settings(LearnedConfig, settings).build(environment.description)
            pair = by_name[folder.name], learned
            seeds = range(arguments.seed, arguments.seed + arguments.proposals)
            print(row(environment, by_name, pair, seeds), flush=True)


def row(
    environment: Environment,
    by_name: dict[str, Primitive],
    pair: tuple[Primitive, Primitive],
    seeds: range,
) -> str:
    """Return a row of the table."""
    won, steps = np.zeros((2, len(seeds)), dtype=bool), np.zeros((2, len(seeds)))
    for number, seed in enumerate(seeds):
        parameters = prepare(environment, by_name, pair[0], seed)
        state = environment.get_state()
        for place, primitive in enumerate(pair):
            environment.set_state(state)
            execution = run_primitive(environment, primitive, parameters)
            won[place, number] = pair[1].succeeded(execution.scenes, parameters)
            steps[place, number] = execution.steps
    shares = [f"{share:.2f}" for share in won.mean(axis=1)]
    lengths = [f"{mean:.0f}" for mean in steps.mean(axis=1)]
    return f"| {pair[0].name} | {shares[0]} | {shares[1]} | {' / '.join(lengths)} |"


def prepare(
    environment: Environment, by_name: dict[str, Primitive], primitive: Primitive, seed: int
) -> Array:
    """Bring about a state that a primitive can start in, and return reachable parameters."""
    generator = np.random.default_rng(seed)
    while True:
        environment.reset(seed=int(generator.integers(2**31)))
        settle(environment)
        if not primitive.can_start(environment.scene()):
            grasp = by_name["grasp"]
            drawn = draw(environment, grasp, generator)
            if drawn is None:
                continue
            run_primitive(environment, grasp, drawn)
            settle(environment, np.array([0.0, 0.0, 0.0, 0.0, 1.0]))
        drawn = draw(environment, primitive, generator)
        if drawn is not None and primitive.can_start(environment.scene()):
            return drawn


def draw(
    environment: Environment, primitive: Primitive, generator: np.random.Generator
) -> Array | None:
    """Return parameters of the prior that the arm can reach, or None."""
    scene = environment.scene()
    for _ in range(ATTEMPTS):
        drawn = primitive.propose(scene, generator)
        if primitive.reachable(scene, drawn):
            return drawn
    return None


if __name__ == "__main__":
    main()

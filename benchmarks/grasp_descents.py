"""How far grasps go below their goals, and how fast the hand is when the fingers begin to close.

    python benchmarks/grasp_descents.py --descents 200

Grasps drawn from the prior, from resets and from far poses before, in every task: from the highest
point of the way on, whether or not something is then held.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from prime_core.execution.motions import run_primitive
from prime_core.experiments.reading import read_experiment

ROOT = Path(__file__).parents[1]
TASKS = ("lift", "pick_place", "nut_assembly", "tidy_up", "clean_up_bin", "clean_up_stack")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--descents", type=int, default=200, help="in each task")
    arguments = parser.parse_args()
    print(
        "| task | descents | lowest below the goal, median / max [mm] "
        "| speed at closing, max [mm/s] | steps | success |"
    )
    print("|---|---|---|---|---|---|")
    for task in TASKS:
        print(row(task, arguments.descents), flush=True)


def row(task: str, descents: int) -> str:
    """Return a row of the table."""
    config = read_experiment(ROOT / "experiments" / f"{task}.yaml")
    environment = config.environment.build()
    primitives = {type_.build(environment.description).name: type_ for type_ in config.primitives}
    grasp = primitives["grasp"].build(environment.description)
    reach = primitives["reach"].build(environment.description)
    generator = np.random.default_rng(0)
    below, speeds, steps, successes = [], [], [], []
    while len(below) < descents:
        environment.reset(seed=int(generator.integers(2**31)))
        if generator.random() < 0.5:
            away = reach.parameter_space.sample(generator)
            if reach.reachable(environment.scene(), away):
                run_primitive(environment, reach, away)
        scene = environment.scene()
        parameters = grasp.propose(scene, generator)
        if not grasp.can_start(scene) or not grasp.reachable(scene, parameters):
            continue
        execution = run_primitive(environment, grasp, parameters)
        closing = np.flatnonzero(execution.actions[:, 4] > 0)
        if not closing.size:
            continue
        first = int(closing[0])
        heights = np.array([item.gripper_position[2] for item in execution.scenes[: first + 1]])
        descent = heights[int(heights.argmax()) :]
        below.append(max(0.0, parameters[2] - descent.min()) * 1e3)
        here, before = (execution.scenes[index].gripper_position for index in (first, first - 1))
        speeds.append(float(np.linalg.norm(here - before)) * 20 * 1e3)
        steps.append(execution.steps)
        successes.append(grasp.succeeded(execution.scenes, parameters))
    return (
        f"| {task} | {len(below)} | {np.median(below):.1f} / {max(below):.1f} | {max(speeds):.0f} "
        f"| {np.mean(steps):.1f} | {np.mean(successes):.2f} |"
    )


if __name__ == "__main__":
    main()

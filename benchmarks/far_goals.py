"""How many reaches to far goals are cut off by their limit of steps.

    python benchmarks/far_goals.py --goals 200
    python benchmarks/far_goals.py --goals 200 --limit 70     # the fixed limit of before

Goals are drawn uniformly in each task's workspace, at least 0.3 m from the gripper, which starts
where it reached the goal before; only goals that `Reach.reachable` does not refuse count.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from unittest.mock import patch

import numpy as np

from prime_core.execution.motions import run_primitive
from prime_core.experiments.reading import read_experiment
from prime_primitives_scripted import scripted
from prime_primitives_scripted.step_limits import approach_limit

ROOT = Path(__file__).parents[1]
TASKS = ("lift", "pick_place", "nut_assembly", "tidy_up", "clean_up_bin", "clean_up_stack")
FAR = 0.3  # [m]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--goals", type=int, default=200, help="in each task")
    parser.add_argument("--limit", type=int, help="a fixed limit of steps in the place of ours")
    arguments = parser.parse_args()
    print("| task | far goals | cut off | of them not reached | steps, mean / longest |")
    print("|---|---|---|---|---|")
    for task in TASKS:
        print(row(task, arguments.goals, arguments.limit), flush=True)


def row(task: str, goals: int, limit: int | None) -> str:
    """Return a row of the table."""
    config = read_experiment(ROOT / "experiments" / f"{task}.yaml")
    environment = config.environment.build()
    reach = next(
        item.build(environment.description)
        for item in config.primitives
        if type(item).__name__ == "ReachConfig"
    )
    generator = np.random.default_rng(0)
    steps, cut, missed, episode = [], 0, 0, 0
    while len(steps) < goals:
        if len(steps) % 10 == 0:  # a fresh start now and then
            environment.reset(seed=episode)
            episode += 1
        scene = environment.scene()
        goal = reach.parameter_space.sample(generator)
        far = np.linalg.norm(goal[:3] - scene.gripper_position) >= FAR
        if not far or not reach.can_start(scene) or not reach.reachable(scene, goal):
            continue
        most = limit or approach_limit(scene, reach._goal(scene, goal))
        with patch.object(scripted, "approach_limit", lambda *_, most=most: most):
            execution = run_primitive(environment, reach, goal)
        steps.append(execution.steps)
        cut += execution.steps >= most
        missed += execution.steps >= most and not reach.succeeded(execution.scenes, goal)
        if not reach.can_start(environment.scene()):
            environment.reset(seed=1000 + episode)
    return f"| {task} | {len(steps)} | {cut} | {missed} | {np.mean(steps):.1f} / {max(steps)} |"


if __name__ == "__main__":
    main()

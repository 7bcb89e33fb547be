"""How near to its parameters a scripted reach ends, with and without inverse kinematics.

Prints a markdown table. Each reach starts from a reset of its own and goes to a pose drawn
uniformly in the workspace. "all" runs every draw, "reachable" only those that the arm can
do; both ways of moving get the same draws.

    python benchmarks/reach_accuracy.py --reaches 200
"""

import argparse
import time
from dataclasses import dataclass, field

import numpy as np

from prime_core.contracts.environment import Environment
from prime_core.execution.motions import run_primitive, settle
from prime_envs_robosuite.config import LiftConfig, PickPlaceConfig
from prime_primitives_scripted.reach import ReachConfig

STUCK = 0.01  # [m]


@dataclass
class Row:
    """Results of one way of moving with one set of draws."""

    errors: list[float] = field(default_factory=list)
    successes: int = 0
    steps: int = 0
    seconds: float = 0.0

    def markdown(self, *names: str) -> str:
        """Return a row of the table that begins with names."""
        errors = np.array(self.errors)
        middle, high, top = 1000 * np.percentile(errors, [50, 95, 100])
        cells = [
            *names,
            str(len(errors)),
            f"{middle:.2f}",
            f"{high:.2f}",
            f"{top:.1f}",
            f"{np.mean(errors > STUCK):.3f}",
            f"{self.successes / len(errors):.3f}",
            f"{self.steps / len(errors):.1f}",
            f"{1000 * self.seconds / self.steps:.2f}",
        ]
        return f"| {' | '.join(cells)} |"


def reach_all(environment: Environment, count: int, kinematics: bool) -> dict[str, Row]:
    """Run reaches; return a row for all draws and one for those that the arm can do."""
    description = environment.description
    judge = ReachConfig().build(description)
    reach = ReachConfig(inverse_kinematics=kinematics).build(description)
    generator = np.random.default_rng(0)
    rows = {"all": Row(), "reachable": Row()}
    for seed in range(count):
        environment.reset(seed=seed)
        settle(environment)
        scene = environment.scene()
        goal = reach.parameter_space.sample(generator)
        start = time.process_time()
        execution = run_primitive(environment, reach, goal)
        seconds = time.process_time() - start
        error = float(np.linalg.norm(execution.scenes[-1].gripper_position - goal[:3]))
        for name in ("all", "reachable") if judge.reachable(scene, goal) else ("all",):
            row = rows[name]
            row.errors.append(error)
            row.successes += reach.succeeded(execution.scenes, goal)
            row.steps += execution.steps
            row.seconds += seconds
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reaches", type=int, default=200, help="draws for each environment")
    count = parser.parse_args().reaches
    titles = ["environment", "draws", "moved by", "n", "median [mm]", "p95 [mm]", "max [mm]"]
    titles += [f"over {1000 * STUCK:.0f} mm", "success", "steps", "CPU ms/step"]
    print(f"| {' | '.join(titles)} |\n|{'---|' * len(titles)}")
    for config in (PickPlaceConfig(), LiftConfig()):
        environment = config.build()
        environment.reset(seed=0)
        environment.step(np.zeros(5))  # compiles
        both = {
            kinematics: reach_all(environment, count, kinematics) for kinematics in (True, False)
        }
        for draws in ("all", "reachable"):
            for kinematics, rows in both.items():
                moved = "inverse kinematics" if kinematics else "pose alone"
                name = type(config).__name__.removesuffix("Config")
                print(rows[draws].markdown(name, draws, moved), flush=True)
        environment.close()


if __name__ == "__main__":
    main()

"""How fast robosuite's tasks step: stock, compiled, and physics alone, in one run.

All contenders start from the same state and take the same actions, a few steps at a time
in turn, so that other load on the machine hits them alike; the figures are medians of CPU
time. "Physics alone" replays the torques of the same steps through MuJoCo's own C loop:
the limit of what any control law could reach. "Collection" is a step of the random primitives of
the collection, with planning, inverse kinematics, scenes and recording; steps of draws that failed
count too.

    python benchmarks/stepping.py [ROUNDS]
"""

import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stock_task import stock_task

from prime_core.collection.episode import Collector
from prime_core.collection.settings import CollectionConfig
from prime_core.execution.world import World
from prime_envs_robosuite.config import (
    CleanUpConfig,
    LiftConfig,
    NutAssemblyConfig,
    PickPlaceConfig,
    RobosuiteConfig,
    TidyUpConfig,
)
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_primitives_scripted.grasp import GraspConfig
from prime_primitives_scripted.place import PlaceConfig
from prime_primitives_scripted.push import PushConfig
from prime_primitives_scripted.reach import ReachConfig

Array = NDArray[np.float64]
Contender = tuple[str, Callable[[], None], Callable[[], None]]  # name, prepare, run

STEPS = 20
EPISODES = 3  # of the collection
CASES: dict[str, tuple[str | None, type[RobosuiteConfig]]] = {
    "PickPlace milk": ("PickPlaceMilk", PickPlaceConfig),
    "Lift": ("Lift", LiftConfig),
    "NutAssembly round": ("NutAssemblyRound", NutAssemblyConfig),
    "TidyUp D": (None, TidyUpConfig),
    "CleanUp bin": (None, CleanUpConfig),
}
"""By title: robosuite's own name of the task, if it has it, and ours."""
PRIMITIVES = (ReachConfig(), GraspConfig(), PlaceConfig(), PushConfig())


def main(rounds: int) -> None:
    print(f"medians of {rounds} rounds of {STEPS} control steps, CPU time")
    for title, (name, kind) in CASES.items():
        compiled, stock = _build(kind()), _build(kind(stepping="stock"))
        contenders = _ours(compiled, stock)
        if name is not None:
            contenders = [_robosuite(name), *contenders]
        times = _measure(contenders, rounds)
        times["collection"] = _collection(compiled)
        base, limit = times[contenders[0][0]], times["physics alone"]
        print(
            f"\n{title:<34}{'ms a step':>11}{'steps a CPU-s':>15}{'x first':>9}{'of physics':>12}"
        )
        for label, value in times.items():
            print(
                f"  {label:<32}{value * 1e3:>11.2f}{1 / value:>15.0f}{base / value:>9.2f}"
                f"{limit / value:>12.2f}"
            )


def _collection(environment: RobosuiteEnvironment) -> float:
    """Return the CPU seconds of a step of the collection."""
    description = environment.description
    built = [config.build(description) for config in PRIMITIVES]
    usable = built if description.affordances_for("push") else built[:3]
    collector = Collector(World(environment, tuple(usable)), CollectionConfig())
    steps = 0
    own_step = environment.step

    def counted(action: Array) -> Any:
        nonlocal steps
        steps += 1
        return own_step(action)

    environment.step = counted  # type: ignore[method-assign]
    start = time.process_time()
    for episode in range(EPISODES):
        collector.collect(np.random.default_rng(episode))
    seconds = time.process_time() - start
    environment.step = own_step  # type: ignore[method-assign]
    return seconds / steps


def _measure(contenders: list[Contender], rounds: int) -> dict[str, float]:
    """Return the median CPU seconds of a control step."""
    samples: dict[str, list[float]] = {label: [] for label, _, _ in contenders}
    for turn in range(rounds + 1):
        for label, prepare, run in contenders:
            prepare()
            start = time.process_time()
            run()
            if turn > 0:  # the first round compiles and fills caches
                samples[label].append((time.process_time() - start) / STEPS)
    return {label: statistics.median(values) for label, values in samples.items()}


def _actions() -> Array:
    """Return motor actions that keep the hand about where it is, ``(STEPS, 5)``."""
    actions = np.random.default_rng(0).uniform(-0.02, 0.02, (STEPS, 5))
    actions[:, 4] = -1.0
    return actions


def _commands() -> Array:
    """Return the same as commands of robosuite's controller, ``(STEPS, 7)``."""
    commands = np.zeros((STEPS, 7))
    commands[:, :3] = _actions()[:, :3] / 0.05
    commands[:, 6] = -1.0
    return commands


def _robosuite(name: str) -> Contender:
    """Return robosuite's own task as it is installed, observations included."""
    task = stock_task(name)
    commands = _commands()
    return "robosuite", task.reset, lambda: [task.step(item) for item in commands] and None


def _ours(compiled: RobosuiteEnvironment, stock: RobosuiteEnvironment) -> list[Contender]:
    compiled.reset(seed=0)
    for _ in range(10):  # let the object come to rest
        compiled.step(np.array([0.0, 0.0, 0.0, 0.0, -1.0]))
    state = compiled.get_state()
    actions, commands = _actions(), _commands()

    def steps(step: Callable[[Array], Any], inputs: Array) -> Callable[[], None]:
        def run() -> None:
            for item in inputs:
                step(item)

        return run

    def to(environment: RobosuiteEnvironment) -> Callable[[], None]:
        return lambda: environment.set_state(state)

    fast, slow = compiled._simulation, stock._simulation
    return [
        ("stock stepping, one object", to(stock), steps(slow.stepper.step, commands)),
        ("compiled environment", to(compiled), steps(compiled.step, actions)),
        ("compiled stepping", to(compiled), steps(fast.stepper.step, commands)),
        ("physics alone", lambda: None, _replay(compiled, stock, state, commands)),
    ]


def _replay(
    compiled: RobosuiteEnvironment, stock: RobosuiteEnvironment, state: Array, commands: Array
) -> Callable[[], None]:
    """Return the physics of the commands' torques, which stock stepping is watched for."""
    import mujoco
    from mujoco import rollout

    simulation = stock._simulation
    host = simulation.host
    torques: list[Array] = []
    own_step2 = host.sim.step2

    def watched_step2() -> None:
        torques.append(simulation.data.ctrl.copy())
        own_step2()

    stock.set_state(state)
    host.sim.step2 = watched_step2
    for item in commands:
        simulation.stepper.step(item)
    host.sim.step2 = own_step2
    controls = np.array(torques)
    model = compiled._simulation.model
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    compiled.set_state(state)
    start = np.empty(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, compiled._simulation.data, start, kind)
    scratch = mujoco.MjData(model)
    return lambda: rollout.rollout(model, scratch, start, controls) and None


def _build(config: RobosuiteConfig) -> RobosuiteEnvironment:
    environment = config.build()
    assert isinstance(environment, RobosuiteEnvironment)
    return environment


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 15)

"""How much more two processes step than one, on a machine with two cores.

One process and two step in turn, some seconds at a time, from the same state; the figures are
medians of steps by the clock.

    python benchmarks/two_processes.py [ROUNDS]
"""

import multiprocessing
import statistics
import sys
import time
from multiprocessing.connection import Connection

import numpy as np

from prime_envs_robosuite.config import (
    CleanUpConfig,
    LiftConfig,
    NutAssemblyConfig,
    PickPlaceConfig,
    RobosuiteConfig,
    TidyUpConfig,
)
from prime_envs_robosuite.environment import RobosuiteEnvironment

CASES: dict[str, RobosuiteConfig] = {
    "PickPlace milk": PickPlaceConfig(),
    "Lift": LiftConfig(),
    "NutAssembly round": NutAssemblyConfig(),
    "TidyUp D": TidyUpConfig(),
    "CleanUp bin": CleanUpConfig(),
}
SECONDS = 2.0
STEPS = 20  # from one state


def main(rounds: int) -> None:
    print(f"medians of {rounds} rounds of {SECONDS:g} s, steps a second by the clock")
    print(f"{'':<24}{'one process':>14}{'two processes':>16}{'x':>7}")
    for title, config in CASES.items():
        workers = [_Worker(config), _Worker(config)]
        single, double = [], []
        for _ in range(rounds):
            single.append(_rate(workers[:1]))
            double.append(_rate(workers))
        for worker in workers:
            worker.stop()
        one, two = statistics.median(single), statistics.median(double)
        print(f"{title:<24}{one:>14.0f}{two:>16.0f}{two / one:>7.2f}", flush=True)


class _Worker:
    """A process that steps one environment when it is told to."""

    def __init__(self, config: RobosuiteConfig) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, other = context.Pipe()
        self._process = context.Process(target=_work, args=(config, other), daemon=True)
        self._process.start()
        self.connection.recv()  # it is ready

    def stop(self) -> None:
        self.connection.send(None)
        self._process.join()


def _rate(workers: list[_Worker]) -> float:
    """Return the steps a second of some workers together."""
    end = time.monotonic() + SECONDS
    for worker in workers:
        worker.connection.send(end)
    return sum(worker.connection.recv() for worker in workers) / SECONDS


def _work(config: RobosuiteConfig, connection: Connection) -> None:
    environment = config.build()
    assert isinstance(environment, RobosuiteEnvironment)
    environment.reset(seed=0)
    still = np.array([0.0, 0.0, 0.0, 0.0, -1.0])
    for _ in range(STEPS):
        environment.step(still)  # compiles, and lets objects come to rest
    state = environment.get_state()
    stepper = environment._simulation.stepper
    command = np.zeros(7)
    connection.send(0)
    while (end := connection.recv()) is not None:
        steps = 0
        while time.monotonic() < end:
            environment.set_state(state)
            for _ in range(STEPS):
                stepper.step(command)
            steps += STEPS
        connection.send(steps)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 5)

"""What it takes to turn recordings into a data set with images, beside robosuite's renderer.

Some demonstrations of Lift are shown, cut to 150 frames, and written again and again as robosuite's
recorder does. `prime convert` is measured from its start to its end, on two of them and on all: the
difference tells what one more takes. Before and after it, robosuite's own task is put into recorded
states and rendered, and no more: no demonstration is read, no file is written, and what it takes to
start is not counted.

Seconds are of CPU time of all processes, for other load on the machine stretches those of the
clock, which stand beside them. A machine whose cores are free needs the CPU time divided by them.

    MUJOCO_GL=egl python benchmarks/convert.py [--demonstrations 20] [--workers 2] [--images png]
"""

import argparse
import multiprocessing
import os
import resource
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray
from stock_task import stock_task

from prime_envs_robosuite.config import LiftConfig
from prime_envs_robosuite.demonstrators.simulated_teleoperator import SimulatedTeleoperatorConfig
from prime_envs_robosuite.simulation.osc_scales import POSITION_SCALE, ROTATION_SCALE
from prime_envs_robosuite.tasks.robosuite_import import quiet_robosuite

FRAMES = 150
WIDTH = 32  # of a recorded state of Lift: time, 16 positions, 15 velocities
SIZE = 84  # pixels
CAMERAS = ("agentview", "robot0_eye_in_hand")
IMAGES = FRAMES * len(CAMERAS)  # of a demonstration
SHOWN = 2  # demonstrations
FEW = 2  # demonstrations that tell what starting takes
STOCK_FRAMES = 50  # rendered with robosuite, before and after
ASKED, MINUTES, CORES = 1000, 30, 2  # demonstrations, in which they should be done, and on what
PRIME = [sys.executable, "-c", "from prime_core.cli import main; main()"]


@dataclass(frozen=True)
class Seconds:
    """What something took.

    Attributes:
        cpu: Of all its processes.
        clock: From start to end.
    """

    cpu: float
    clock: float


def main(count: int, workers: int, kept_as: str) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        states = _record(folder, count)
        before = _stock(states)
        few, many = (_converted(folder, which, workers, kept_as) for which in ("few", "many"))
        after = _stock(states)
    each = (many.cpu - few.cpu) / (count - FEW) / IMAGES
    stock = (before + after) / 2
    print(f"{FRAMES} frames, cameras {', '.join(CAMERAS)}, {SIZE} x {SIZE}, {kept_as}")
    print(f"load of the machine {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores")
    for number, took in ((FEW, few), (count, many)):
        print(
            f"prime convert, {workers} workers, {number} demonstrations: {took.cpu:.1f} s of CPU "
            f"time, {took.clock:.1f} s by the clock"
        )
    print(f"  an image: {1000 * each:.2f} ms of CPU time")
    print(
        f"robosuite's renderer alone, an image: {1000 * stock:.2f} ms of CPU time (before "
        f"{1000 * before:.2f}, after {1000 * after:.2f}): {stock / each:.1f} x"
    )
    ours = few.cpu + (ASKED - FEW) * IMAGES * each
    theirs = ASKED * IMAGES * stock
    print(
        f"{ASKED} demonstrations on {CORES} free cores: {ours / CORES / 60:.1f} min (asked: under "
        f"{MINUTES}); robosuite's renderer alone {theirs / CORES / 60:.1f} min"
    )


def _record(folder: Path, count: int) -> NDArray[np.float64]:
    """Write a file of all demonstrations and one of a few; return the states that were shown."""
    config = SimulatedTeleoperatorConfig(count=SHOWN, steps=(FRAMES, 500), ends_when_solved=False)
    scales = np.array([*[POSITION_SCALE] * 3, ROTATION_SCALE])
    found = []
    for number in range(SHOWN):
        one = config.demonstrate(LiftConfig(), number, 0)
        assert one.simulator_states is not None
        states = one.simulator_states[:FRAMES, :WIDTH].copy()
        states[:, 0] = 0.05 * np.arange(FRAMES)
        actions = np.zeros((FRAMES, 7))
        actions[:, [0, 1, 2, 5]] = one.actions[:FRAMES, :4] / scales
        actions[:, 6] = one.actions[:FRAMES, 4]
        found.append((states, actions))
    for name, demonstrations in (("few", FEW), ("many", count)):
        with h5py.File(folder / f"{name}.hdf5", "w") as file:
            file.create_group("data").attrs["env"] = "Lift"
            for number in range(demonstrations):
                group = file["data"].create_group(f"demo_{number + 1}")
                group["states"], group["actions"] = found[number % SHOWN]
    return np.concatenate([states for states, _ in found])


def _converted(folder: Path, name: str, workers: int, kept_as: str) -> Seconds:
    """Convert a file and return what it took."""
    cameras = [part for camera in CAMERAS for part in ("--camera", camera)]
    options = [*cameras, "--size", str(SIZE), "--images", kept_as, "--workers", str(workers)]
    places = [str(folder / f"{name}.hdf5"), str(folder / name)]
    cpu, clock = _children(), time.perf_counter()
    subprocess.run([*PRIME, "convert", *places, *options], check=True, stdout=subprocess.DEVNULL)
    return Seconds(_children() - cpu, time.perf_counter() - clock)


def _children() -> float:
    """Return the CPU seconds of all processes that this one started and that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _stock(states: NDArray[np.float64]) -> float:
    """Return the CPU seconds that an image of robosuite's own task takes."""
    chosen = states[np.linspace(0, len(states) - 1, STOCK_FRAMES).astype(np.int64)]
    # A process of its own: robosuite's rendering does not survive a second task in one.
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as processes:
        return processes.submit(_rendered, chosen).result()


def _rendered(states: NDArray[np.float64]) -> float:
    task = stock_task("Lift", pictures=True)
    with quiet_robosuite():
        task.reset()
        task.sim.render(SIZE, SIZE, camera_name=CAMERAS[0])
    begin = time.process_time()
    for state in states:
        task.sim.set_state_from_flattened(state)
        task.sim.forward()
        for camera in CAMERAS:
            task.sim.render(SIZE, SIZE, camera_name=camera)
    return (time.process_time() - begin) / len(states) / len(CAMERAS)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--demonstrations", type=int, default=20)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--images", choices=("png", "video"), default="png")
    given = parser.parse_args()
    main(given.demonstrations, given.workers, given.images)

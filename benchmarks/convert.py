"""How fast recordings become a data set with images, beside robosuite's renderer.

Some demonstrations of Lift are shown, cut to 150 frames, and written again and again as robosuite's
recorder does.
`prime convert` is timed by the clock from its start to its end, on two of them and on all: the
difference tells what one more takes. Before and after it as many processes put the recorded states
into robosuite's own task and render them, and do no more: no demonstration is read, no file is
written, and what they take to start is not counted. Other load on the machine is in all figures.

    MUJOCO_GL=egl python benchmarks/convert.py [--demonstrations 20] [--workers 2] [--images png]
"""

import argparse
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
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
SHOWN = 4  # demonstrations
FEW = 2  # demonstrations that tell what starting takes
STOCK_FRAMES = 300  # that each process renders with robosuite, before and after
ASKED = 1000  # demonstrations
PRIME = [sys.executable, "-c", "from prime_core.cli import main; main()"]


def main(count: int, workers: int, kept_as: str) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        states = _record(folder, count)
        before = _stock_rate(states, workers)
        few = _converted(folder, "few", workers, kept_as)
        many = _converted(folder, "many", workers, kept_as)
        after = _stock_rate(states, workers)
    each = (many - few) / (count - FEW)
    ours, stock = FRAMES * len(CAMERAS) / each, (before + after) / 2
    print(f"{FRAMES} frames, cameras {', '.join(CAMERAS)}, {SIZE} x {SIZE}, {kept_as}")
    print(f"load of the machine {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores")
    print(f"prime convert, {workers} workers, {FEW} demonstrations: {few:.1f} s")
    print(f"prime convert, {workers} workers, {count} demonstrations: {many:.1f} s")
    print(f"  each one more: {each:.2f} s, {ours:.0f} images a second")
    print(f"robosuite's renderer alone, {workers} processes: {stock:.0f} images a second")
    print(f"  before {before:.0f}, after {after:.0f}; prime convert is {ours / stock:.2f} x")
    total = (few + (ASKED - FEW) * each) / 60
    print(f"{ASKED} demonstrations would take {total:.1f} min, and were asked for in under 30")


def _record(folder: Path, count: int) -> NDArray[np.float64]:
    """Write a file of all demonstrations and one of a few; return the states of all."""
    shown = SimulatedTeleoperatorConfig(count=SHOWN, steps=(FRAMES, 500), ends_when_solved=False)
    scales = np.repeat([POSITION_SCALE, ROTATION_SCALE], 3)
    demonstrations = [shown.demonstrate(LiftConfig(), number, 0) for number in range(SHOWN)]
    found = []
    with h5py.File(folder / "many.hdf5", "w") as many, h5py.File(folder / "few.hdf5", "w") as few:
        for number in range(count):
            one = demonstrations[number % SHOWN]
            assert one.simulator_states is not None
            states = one.simulator_states[:FRAMES, :WIDTH].copy()
            states[:, 0] = 0.05 * np.arange(FRAMES)
            actions = np.zeros((FRAMES, 7))
            actions[:, [0, 1, 2, 5]] = one.actions[:FRAMES, :4] / scales[[0, 1, 2, 5]]
            actions[:, 6] = one.actions[:FRAMES, 4]
            for file in (many, few) if number < FEW else (many,):
                file.require_group("data").attrs["env"] = "Lift"
                group = file["data"].create_group(f"demo_{number + 1}")
                group["states"], group["actions"] = states, actions
            found.append(states)
    return np.stack(found)


def _converted(folder: Path, name: str, workers: int, kept_as: str) -> float:
    """Convert a file and return the seconds that it took."""
    cameras = [part for camera in CAMERAS for part in ("--camera", camera)]
    options = [*cameras, "--size", str(SIZE), "--images", kept_as, "--workers", str(workers)]
    begin = time.perf_counter()
    places = [str(folder / f"{name}.hdf5"), str(folder / name)]
    subprocess.run([*PRIME, "convert", *places, *options], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - begin


def _stock_rate(states: NDArray[np.float64], processes: int) -> float:
    """Return the images a second that processes render together with robosuite's own task."""
    spawn = multiprocessing.get_context("spawn")
    ready = spawn.Barrier(processes)
    rows = states.reshape(-1, WIDTH)
    chosen = rows[np.linspace(0, len(rows) - 1, STOCK_FRAMES).astype(np.int64)]
    seconds = spawn.SimpleQueue()
    started = [
        spawn.Process(target=_render, args=(chosen, ready, seconds)) for _ in range(processes)
    ]
    for process in started:
        process.start()
    for process in started:
        process.join()
        assert process.exitcode == 0
    return sum(STOCK_FRAMES * len(CAMERAS) / seconds.get() for _ in started)


def _render(states: NDArray[np.float64], ready: object, seconds: object) -> None:
    task = stock_task("Lift", pictures=True)
    with quiet_robosuite():
        task.reset()
        task.sim.render(SIZE, SIZE, camera_name=CAMERAS[0])
    ready.wait()  # type: ignore[attr-defined]
    begin = time.perf_counter()
    for state in states:
        task.sim.set_state_from_flattened(state)
        task.sim.forward()
        for camera in CAMERAS:
            task.sim.render(SIZE, SIZE, camera_name=camera)
    seconds.put(time.perf_counter() - begin)  # type: ignore[attr-defined]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--demonstrations", type=int, default=20)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--images", choices=("png", "video"), default="png")
    given = parser.parse_args()
    main(given.demonstrations, given.workers, given.images)

"""How fast pictures are made without a GPU, and how far light meshes are from the full ones.

All contenders look at the same instants, a few frames at a time in turn, so that other load on the
machine hits them alike; the figures are medians of CPU time of the whole process, Mesa's threads
included. "robosuite" is its own off-screen rendering as it is installed. "before" is what prime did
at first: all faces and all geoms, in a buffer of 640 x 480, without shadows, reflections and
multisampling. "full" are all faces of what is in the picture. "light" is what prime does. A physics
step is a control step of the compiled environment.

    MUJOCO_GL=egl python benchmarks/rendering.py [ROUNDS] [--sheet FILE]
"""

import argparse
import multiprocessing
import statistics
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from stock_task import stock_task

from prime_core.contracts.observations import Observations
from prime_envs_robosuite.config import (
    CleanUpConfig,
    LiftConfig,
    NutAssemblyConfig,
    PickPlaceConfig,
    RobosuiteConfig,
    TidyUpConfig,
)
from prime_envs_robosuite.demonstrators.simulated_teleoperator import SimulatedTeleoperatorConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.pictures.cameras import ALIASES, Meshes
from prime_envs_robosuite.tasks.robosuite_import import quiet_robosuite

Maker = Callable[[Observations, tuple[str, ...]], object]
Images = dict[str, NDArray[np.uint8]]

SIZE = 84  # pixels
SIZES = (84, 256)
FRAMES = 5  # in each turn
STEPS = (50, 2000)  # of an episode
COMPARED = 40  # frames of an episode
CAMERAS = {"agentview": ("agentview",), "wrist": ("wrist",), "both": ("agentview", "wrist")}
CASES: dict[str, tuple[str | None, type[RobosuiteConfig]]] = {
    "PickPlace milk": ("PickPlaceMilk", PickPlaceConfig),
    "Lift": ("Lift", LiftConfig),
    "NutAssembly round": ("NutAssemblyRound", NutAssemblyConfig),
    "TidyUp D": (None, TidyUpConfig),
    "CleanUp bin": (None, CleanUpConfig),
}
"""By title: robosuite's own name of the task, if it has it, and ours."""


def main(rounds: int, sheet: Path | None) -> None:
    print(f"medians of {rounds} rounds of {FRAMES} frames, {SIZE} x {SIZE}, CPU time")
    shown = []
    # A process each: robosuite's rendering does not survive a second task in one.
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn, max_tasks_per_child=1) as processes:
        for title in CASES:
            shown += processes.submit(_compare, title, rounds).result()
    if sheet is not None:
        _draw(shown, sheet)


def _compare(title: str, rounds: int) -> list[list[Images]]:
    """Print the figures of a task; return full and light pictures of an instant, by size."""
    name, kind = CASES[title]
    # First, for at the process's end it shuts down what our pictures are freed with.
    makers = {} if name is None else {"robosuite": _robosuite(name)}
    shown = SimulatedTeleoperatorConfig(count=1, steps=STEPS).demonstrate(kind(), 0, 0)
    seen = shown.observations
    environments = [_build(kind(), meshes) for meshes in ("light", "full", "full")]
    light, full, before = environments
    _as_before(before, seen)
    makers["before"] = _pictures_of(before)
    makers["full"] = _pictures_of(full)
    makers["light"] = _pictures_of(light)
    _print_speeds(title, _measure(makers, seen, rounds), _physics(light, rounds))
    few = seen[np.linspace(0, len(seen) - 1, COMPARED).astype(np.int64)]
    found = []
    for size in SIZES:
        pair = [item.pictures(few, CAMERAS["both"], size, size) for item in (full, light)]
        _print_difference(size, *pair)
        found.append([{key: one[key][COMPARED // 2] for key in one} for one in pair])
    for environment in environments:
        environment.close()
    return found


def _pictures_of(environment: RobosuiteEnvironment) -> Maker:
    return lambda few, cameras: environment.pictures(few, cameras, SIZE, SIZE)


def _measure(
    makers: dict[str, Maker],
    seen: Observations,
    rounds: int,
) -> dict[tuple[str, str], float]:
    """Return the median CPU seconds of a frame, by contender and cameras."""
    samples: dict[tuple[str, str], list[float]] = {}
    starts = np.linspace(0, len(seen) - FRAMES, rounds + 1).astype(int)
    for turn, start in enumerate(starts):
        few = seen[start : start + FRAMES]
        for views, cameras in CAMERAS.items():
            for label, make in makers.items():
                begin = time.process_time()
                make(few, cameras)
                if turn > 0:  # the first round compiles models and shaders
                    seconds = (time.process_time() - begin) / FRAMES
                    samples.setdefault((label, views), []).append(seconds)
    return {key: statistics.median(values) for key, values in samples.items()}


def _physics(environment: RobosuiteEnvironment, rounds: int) -> float:
    """Return the median CPU seconds of a control step."""
    environment.reset(seed=0)
    samples = []
    for _ in range(rounds + 1):
        begin = time.process_time()
        for _ in range(FRAMES):
            environment.step(np.array([0.0, 0.0, 0.0, 0.0, -1.0]))
        samples.append((time.process_time() - begin) / FRAMES)
    return statistics.median(samples[1:])


def _as_before(environment: RobosuiteEnvironment, seen: Observations) -> None:
    """Let all geoms be drawn, in a buffer of robosuite's size."""
    environment.pictures(seen[:1], ("agentview",), 480, 640)
    look = environment._cameras._look("full")
    everything = np.ones(look._model.ngeom, dtype=np.bool_)
    look._may_be_seen = lambda camera, aspect: everything  # type: ignore[method-assign]


def _robosuite(name: str) -> Maker:
    """Return robosuite's own task, which looks at where its episodes start."""
    task = stock_task(name, pictures=True)
    with quiet_robosuite():
        task.reset()
        task.sim.render(SIZE, SIZE, camera_name="agentview")

    def make(few: Observations, cameras: tuple[str, ...]) -> None:
        task.sim._render_context_offscreen.gl_ctx.make_current()
        for _ in range(len(few)):
            task.sim.forward()
            for camera in cameras:
                task.sim.render(SIZE, SIZE, camera_name=ALIASES[camera])

    return make


def _build(config: RobosuiteConfig, meshes: Meshes) -> RobosuiteEnvironment:
    built = config.build()
    assert isinstance(built, RobosuiteEnvironment)
    return RobosuiteEnvironment(built.task, meshes=meshes)


def _print_speeds(title: str, times: dict[tuple[str, str], float], step: float) -> None:
    labels = list(dict.fromkeys(label for label, _ in times))
    print(f"\n{title:<20}" + "".join(f"{views + ' (x before)':>24}" for views in CAMERAS))
    for label in labels:
        speeds = [(1 / times[label, views], 1 / times["before", views]) for views in CAMERAS]
        cells = [f"{now:>15.0f} ({now / before:5.1f})" for now, before in speeds]
        print(f"  {label:<18}" + "".join(f"{cell:>24}" for cell in cells))
    print(f"  {'physics steps':<18}{1 / step:>15.0f}")


def _print_difference(size: int, full: Images, light: Images) -> None:
    cells = []
    for name, images in full.items():
        apart = np.abs(images.astype(np.int16) - light[name])
        cells.append(
            f"{name} {apart.mean():.2f} (worst picture {apart.mean(axis=(1, 2, 3)).max():.2f})"
        )
    print(f"  grey levels from full, {size}: " + ", ".join(cells))


def _draw(shown: list[list[Images]], path: Path) -> None:
    """Write full pictures, and light ones below them."""
    import matplotlib.pyplot as plt

    columns = [(pair, name) for pair in shown for name in CAMERAS["both"]]
    half = len(SIZES) * len(CAMERAS["both"])
    figure, axes = plt.subplots(
        2 * (len(columns) // half), half, figsize=(3 * half, 6 * (len(columns) // half))
    )
    for index, (pair, name) in enumerate(columns):
        block, column = divmod(index, half)
        for row, images in enumerate(pair):
            axis = axes[2 * block + row, column]
            axis.imshow(images[name], interpolation="nearest")
            axis.set_title(f"{('full', 'light')[row]}, {len(images[name])}", fontsize=8)
            axis.set_axis_off()
    figure.tight_layout()
    figure.savefig(path, dpi=80)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rounds", type=int, nargs="?", default=7)
    parser.add_argument("--sheet", type=Path, help="where to write a contact sheet")
    given = parser.parse_args()
    main(given.rounds, given.sheet)

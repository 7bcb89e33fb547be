"""Runs the stages of an experiment, with progress bars."""

import logging
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import submitit
from rich.console import Console
from rich.markup import escape
from submitit.local import local

from prime_core.errors import PrimeError
from prime_core.experiments.compatibility import check_environments
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.progress_bar import _progress
from prime_core.experiments.reading import dump_experiment
from prime_core.experiments.slurm import jobs_watched_in_queue
from prime_core.experiments.stages.stage import PARENT_VARIABLE, Stage
from prime_core.files import new_file


def run_experiment(experiment: Experiment, console: Console, until: str | None = None) -> None:
    """Run all stages that are not done.

    Args:
        experiment: What to run.
        console: Where progress is shown.
        until: The last stage to run, or None for all.

    Raises:
        PrimeError: If a stage cannot be done for a reason that the user can mend.
    """
    stages = experiment.until(until)
    check_environments(experiment)
    write_resolved(experiment)
    for name, stage in stages.items():
        total, missing = len(stage.items()), len(stage.missing())
        if not missing:
            console.print(f"[green]✓[/] {name} [dim]was done before[/]")
            continue
        try:
            with _ready_for_workers(stage), _progress(console, name, stage, total):
                run_stage(stage)
        except PrimeError as error:
            if not stage.optional:
                raise
            console.print(f"[yellow]-[/] {name} left out: {escape(str(error))}", highlight=False)
            continue
        console.print(f"[green]✓[/] {name} [dim]in {wall_seconds(stage):.1f} s[/]", highlight=False)


def write_resolved(experiment: Experiment) -> Path:
    """Write the experiment with all defaults beside what it makes."""
    path = experiment.folder / "experiment.yaml"
    with new_file(path) as aside:
        aside.write_text(dump_experiment(experiment.config), encoding="utf-8")
    return path


def run_stage(stage: Stage) -> None:
    """Do what is missing of a stage.

    Raises:
        PrimeError: If an item cannot be done for a reason that the user can mend.
    """
    if stage.infra.cluster == "slurm" and shutil.which("srun") is None:
        raise PrimeError(
            "compute.cluster: found 'slurm', but there is no srun here: start the experiment where "
            "jobs can be submitted, or use 'local'"
        )
    start = time.perf_counter()
    try:
        stage.compute(stage.missing())
    except (submitit.core.utils.FailedJobError, submitit.core.utils.UncompletedJobError) as error:
        if stage.error_file.exists():
            raise PrimeError(stage.error_file.read_text(encoding="utf-8")) from None
        raise PrimeError(
            f"a worker of stage {stage.title!r} stopped: {str(error).strip()[-2000:]}\n"
            f"Its logs are under {stage.folder / 'logs'}"
        ) from None
    finally:
        seconds = wall_seconds(stage) + time.perf_counter() - start
        (stage.folder / "wall_seconds.txt").write_text(f"{seconds}")


def wall_seconds(stage: Stage) -> float:
    """Return how long a stage took by the clock [s], all runs of it together."""
    try:
        return float((stage.folder / "wall_seconds.txt").read_text())
    except (OSError, ValueError):
        return 0.0


@contextmanager
def _quiet_at_interrupts() -> Iterator[None]:
    """Start the processes that watch submitit's local jobs without a stderr of their own.

    Ctrl-C in a terminal ends them too, each with a traceback. What jobs print goes to their logs.
    """
    start = local.start_controller

    def quietly(*arguments: Any, **options: Any) -> Any:
        kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, 2)
        try:
            return start(*arguments, **options)
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            os.close(nothing)

    local.start_controller = quietly
    try:
        yield
    finally:
        local.start_controller = start


@contextmanager
def _ready_for_workers(stage: Stage) -> Iterator[None]:
    # Workers share the cores among themselves, each with one thread.
    settings = {"OMP_NUM_THREADS": "1", "TQDM_DISABLE": "1"}
    if stage.infra.cluster == "local":
        # They stop when this process is gone; jobs of Slurm go on and are found by the next run.
        settings[PARENT_VARIABLE] = str(os.getpid())
    before = {name: os.environ.get(name) for name in settings}
    os.environ.update(settings)
    logger = logging.getLogger("exca")
    level = logger.level
    logger.setLevel(logging.WARNING)
    try:
        with jobs_watched_in_queue(), _quiet_at_interrupts():
            yield
    finally:
        logger.setLevel(level)
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value

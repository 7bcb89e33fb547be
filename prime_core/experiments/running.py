"""Runs the stages of an experiment, with progress bars."""

import logging
import os
import re
import shutil
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape
from submitit.core.utils import FailedJobError, UncompletedJobError
from submitit.local import local

from prime_core.errors import PrimeError
from prime_core.experiments.compatibility import check_environments, check_primitives
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.progress_bar import _progress
from prime_core.experiments.reading import dump_experiment, read_experiment
from prime_core.experiments.run_folder.cache import mend
from prime_core.experiments.run_folder.outputs import (
    RESOLVED,
    changed_keys,
    is_of_others,
    read_owner,
    set_aside,
    write_resolved,
)
from prime_core.experiments.run_folder.parent import PARENT_VARIABLE
from prime_core.experiments.run_folder.place import PlaceError, place_error, probed
from prime_core.experiments.slurm import jobs_watched_in_queue
from prime_core.experiments.stages.demonstrations import Demonstrations, check_left_out
from prime_core.experiments.stages.idm import IdmTraining
from prime_core.experiments.stages.perception import PerceptionTraining
from prime_core.experiments.stages.policy import PolicyTraining
from prime_core.experiments.stages.stage import Stage

_SHOWN = 4
"""Keys that are shown of those in which settings differ."""


def run_experiment(experiment: Experiment, console: Console, until: str | None = None) -> None:
    """Run all stages that are not done.

    Args:
        experiment: What to run. No other run may be at work in its folder.
        console: Where progress is shown.
        until: The last stage to run, or None for all.

    Raises:
        PrimeError: If a stage cannot be done for a reason that the user can mend.
    """
    stages = experiment.until(until)
    if experiment.collection.missing():
        check_primitives(experiment.config)
    check_environments(experiment)
    if experiment.config.compute.cluster == "local":
        check_devices(stages.values())
    take_folder(experiment, console)
    for name, stage in stages.items():
        try:
            finish_stage(name, stage, console)
        except PrimeError as error:
            if not stage.optional or isinstance(error, PlaceError):
                raise
            console.print(f"[yellow]-[/] {name} left out: {escape(str(error))}", highlight=False)
            continue
        _tell_left_out(console, stage, experiment.config.strict)


def finish_stage(name: str, stage: Stage, console: Console) -> None:
    """Do what is missing of a stage and what is damaged, and show how far it is.

    Args:
        name: Of the stage, for people.
        stage: Which. No other run may be at work in its folder.
        console: Where progress is shown.

    Raises:
        PrimeError: If it cannot be done for a reason that the user can mend.
    """
    mend(stage.folder)
    damaged = stage.drop_damaged()
    if damaged:
        text = f"{len(damaged)} {stage.unit} of {name} were damaged, and are made anew"
        console.print(f"[yellow]![/] {text}", highlight=False, soft_wrap=True)
    if not stage.missing():
        console.print(f"[green]✓[/] {name} [dim]was done before[/]")
        return
    with _ready_for_workers(stage), _progress(console, name, stage, len(stage.items())):
        run_stage(stage)
    console.print(f"[green]✓[/] {name} [dim]in {wall_seconds(stage):.1f} s[/]", highlight=False)


def check_devices(stages: Iterable[Stage]) -> None:
    """Make sure that this machine can do the trainings that are missing where they are asked for.

    Raises:
        PrimeError: If one cannot be done.
    """
    for stage in stages:
        if isinstance(stage, PerceptionTraining | IdmTraining | PolicyTraining) and stage.missing():
            stage.config.check_device(stage.device)


def _tell_left_out(console: Console, stage: Stage, strict: bool) -> None:
    """List the demonstrations that cannot be used; stop where the experiment asks for all."""
    if isinstance(stage, Demonstrations):
        reasons = stage.left_out()
        check_left_out(reasons, len(stage.items()), strict)
        for item, reason in reasons.items():
            text = f"  demonstration {item} left out: {reason}"
            console.print(text, highlight=False, markup=False, soft_wrap=True)


def take_folder(experiment: Experiment, console: Console) -> None:
    """Make a folder that of this experiment: set aside what others left in it, and say so."""
    folder, text = experiment.folder, dump_experiment(experiment.config)
    if holds_others(experiment):
        owner = read_owner(folder)
        keys = changed_keys(owner.text, text) if owner and not owner.damaged else []
        what = f"settings ({', '.join(keys[:_SHOWN])})" if keys else "data, code or settings"
        place = os.path.relpath(set_aside(folder), folder)
        console.print(
            f"[yellow]![/] {folder} held results of other {what}: they are under {place} now",
            highlight=False,
            soft_wrap=True,
        )
    write_resolved(folder, text, experiment.identity)


def holds_others(experiment: Experiment) -> bool:
    """Whether the folder of an experiment holds results that are not its own.

    Those of the experiment without some variants or policies are its own.
    """
    folder = experiment.folder
    if not is_of_others(folder, dump_experiment(experiment.config), experiment.identity):
        return False
    owner = read_owner(folder)
    if owner is None or owner.damaged or owner.identity is None:
        return True
    try:
        before = Experiment(read_experiment(folder / RESOLVED), folder)
    except PrimeError:  # another version of prime, or without a plugin that is gone
        return True
    is_part = before.uids.items() <= experiment.uids.items()
    return not (is_part and before.identity == owner.identity)


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
        stage.folder.mkdir(parents=True, exist_ok=True)
        stage.error_file.unlink(missing_ok=True)
        stage.begin()
        stage.compute(stage.missing())
    except PrimeError:
        raise
    except Exception as error:  # libraries that are not in Python tell of a full disk in many types
        raise _told(stage, error) or error from None
    finally:
        seconds = wall_seconds(stage) + time.perf_counter() - start
        with suppress(OSError):
            (stage.folder / "wall_seconds.txt").write_text(f"{seconds}")


def _told(stage: Stage, error: Exception) -> PrimeError | None:
    """Return an error as one that the user can mend, or None if it is none."""
    of_worker = isinstance(error, UncompletedJobError)  # or one that failed
    if of_worker and (text := _text_of(stage.error_file)):
        return PrimeError(text)
    place = place_error(error, stage.folder) or (probed(stage.folder) if of_worker else None)
    if place is not None or not of_worker:
        return place
    logs = f"Its logs are under {stage.folder / 'logs'}"
    if not isinstance(error, FailedJobError):
        state = re.search(r"state: (\w+)", str(error))
        return PrimeError(
            f"a worker of stage {stage.title!r} stopped ({state.group(1) if state else 'gone'}): "
            "something ended it, such as a kill or want of memory. What it had finished is kept: "
            f"run again. {logs}"
        )
    # submitit gives the traceback between dashes, and exceptions stand at the start of a line.
    trace = re.split("^-{5,}$", str(error), flags=re.MULTILINE)[1:2]
    raised = re.findall(r"^[A-Za-z_][\w.]*(?::.*)?$", trace[0] if trace else "", re.MULTILINE)
    what = raised[-1] if raised else "for an unknown reason"
    return PrimeError(f"a worker of stage {stage.title!r} stopped: {what}. {logs}")


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8").strip()
    except OSError:
        return ""


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
    logger.setLevel(logging.ERROR)  # its warnings hold tracebacks
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

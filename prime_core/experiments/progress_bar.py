"""Shows how far a stage is."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from prime_core.contracts.training import Progress as TrainingProgress
from prime_core.experiments.stages.stage import Stage

POLL_SECONDS = 0.5


class _Rate(ProgressColumn):
    """Items a second, or seconds an item."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        if not speed:
            return Text("")
        return Text(f"{speed:.1f}/s" if speed >= 1 else f"{1 / speed:.1f} s each", style="dim")


def _bar(console: Console, unit: str) -> Progress:
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.1f}/{task.total:.0f} " + unit),
        _Rate(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console,
        transient=True,
    )


@contextmanager
def training_bar(console: Console) -> Iterator[Callable[[str], TrainingProgress]]:
    """Give a function that returns, for the name of a training, what shows how far it is."""
    bar = _bar(console, "epochs")

    def start(name: str) -> TrainingProgress:
        task = bar.add_task(name, total=1)
        return lambda done, total: bar.update(task, completed=done, total=total)

    with bar:
        yield start


@contextmanager
def _progress(console: Console, name: str, stage: Stage, total: int) -> Iterator[None]:
    bar = _bar(console, stage.unit)
    finished = threading.Event()
    with bar:
        task = bar.add_task(name, total=total)
        bar.update(task, completed=stage.fraction_done())

        def watch() -> None:
            while not finished.wait(POLL_SECONDS):
                bar.update(task, completed=stage.fraction_done())

        thread = threading.Thread(target=watch, daemon=True)
        thread.start()
        try:
            yield
        finally:
            finished.set()
            thread.join()

"""Draws the success rates of several experiments as one figure."""

from collections.abc import Sequence
from itertools import chain
from pathlib import Path

from prime_core.errors import PrimeError
from prime_core.experiments.results.measured import Against, Measured, bars_of, points_of
from prime_core.experiments.results.tasks import ResultsFile, publishers, tasks_of
from prime_core.reporting.success_bars import Bar, draw_success_bars
from prime_core.reporting.success_curves import Curve, CurvePoint, draw_success_curves

SUFFIXES = (".png", ".pdf", ".svg")

_WORDS = {
    Against.DEMONSTRATIONS: "demonstrations",
    Against.TRANSITIONS: "transitions collected",
}
_SETTINGS = {
    Against.DEMONSTRATIONS: "demonstrations.count",
    Against.TRANSITIONS: "collection.episodes",
}
"""What a variant changes so that its number differs."""


def check_figure(path: Path) -> None:
    """Make sure that a figure can be of this kind, before anything is read.

    Raises:
        PrimeError: If its suffix is none that is drawn, or it is a folder.
    """
    if path.suffix.lower() not in SUFFIXES:
        found = f"the suffix {path.suffix!r}" if path.suffix else "no suffix"
        raise PrimeError(f"--figure {path}: found {found}; it must be {', '.join(SUFFIXES)}")
    if path.is_dir():
        raise PrimeError(f"--figure {path}: is a folder; name a file")


def draw_comparison(
    figure: Path,
    paths: Sequence[Path],
    files: Sequence[ResultsFile],
    *,
    against: Against | None = None,
    methods: Sequence[str] = (),
) -> None:
    """Draw success rates of the best checkpoints: bars, or lines against a number.

    Args:
        figure: Where; see `check_figure`.
        paths: Where each results file lies.
        files: What each holds.
        against: What lines are drawn against; None for bars.
        methods: Which are drawn, in this order; none for all.

    Raises:
        PrimeError: If there is nothing to draw, or what a figure does not tell apart.
    """
    tasks = tasks_of(paths, files)
    found = {
        task.title: bars_of(task) if against is None else points_of(task, against) for task in tasks
    }
    names = _chosen([*chain.from_iterable(found.values())], methods, paths, against)
    shown = {title: [one for one in found[title] if one.method in names] for title in found}
    shown = {title: rates for title, rates in shown.items() if rates}
    has_published = any(rate.published for rate in chain.from_iterable(shown.values()))
    publisher = publishers(files) if has_published else ""
    if against is None:
        bars = {title: [*map(_bar, rates)] for title, rates in shown.items()}
        draw_success_bars(figure, bars, names, publisher)
        return
    curves = {title: _curves(rates) for title, rates in shown.items()}
    draw_success_curves(figure, curves, names, _WORDS[against], publisher)


def _chosen(
    rates: Sequence[Measured],
    methods: Sequence[str],
    paths: Sequence[Path],
    against: Against | None,
) -> list[str]:
    """Return the methods to draw, in their order."""
    there = [*dict.fromkeys(rate.method for rate in rates)]
    for name in methods:
        if name not in there:
            listing = ", ".join(map(repr, there)) or "none"
            raise PrimeError(f"--method {name!r}: there is no such method. There are: {listing}")
    where = ", ".join(map(str, paths))
    if not rates and against is None:
        raise PrimeError(f"{where}: nothing to draw: no policy was evaluated there")
    if against is not None and len({rate.number for rate in rates if not rate.published}) < 2:
        raise PrimeError(
            f"{where}: nothing to draw against {against}: it takes policies that were evaluated "
            f"with two numbers of them at least, such as those of an experiment whose variants "
            f"change {_SETTINGS[against]}"
        )
    return [*dict.fromkeys(methods or there)]


def _bar(rate: Measured) -> Bar:
    return Bar(rate.method, rate.mean, rate.deviation, published=rate.published)


def _curves(rates: Sequence[Measured]) -> list[Curve]:
    keys = dict.fromkeys((rate.method, rate.published) for rate in rates)
    return [
        Curve(
            method,
            tuple(
                CurvePoint(rate.number, rate.mean, rate.deviation)
                for rate in rates
                if (rate.method, rate.published) == (method, published)
            ),
            published=published,
        )
        for method, published in keys
    ]

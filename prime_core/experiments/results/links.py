"""Puts links to what an experiment made for people beside its results."""

import os
from pathlib import Path

from prime_core.experiments.experiment import Experiment


def link_outputs(experiment: Experiment) -> list[Path]:
    """Link the data set, the timelines and the videos into the experiment's folder.

    They lie in the folders of the stages that made them; a link shows the newest.

    Returns:
        The links, and the results file where there is one.
    """
    links: list[Path] = []
    if not experiment.export.missing():
        for name in experiment.export.items():
            links.append(_link(experiment.folder / name, experiment.export.folder / name))
    for name, video in experiment.videos.items():
        if not video.missing():
            file = video.folder / str(video.results()[0]["file"])
            links.append(_link(experiment.folder / f"episode-{name}.mp4", file))
    results = experiment.folder / "results.json"
    return [*links, results] if results.exists() else links


def _link(link: Path, target: Path) -> Path:
    relative = os.path.relpath(target, link.parent)
    if link.exists() and not link.is_symlink():
        return link  # a copy of a run's folder may hold the things themselves
    if not (link.is_symlink() and os.readlink(link) == relative):
        aside = link.with_name(link.name + ".tmp")
        aside.unlink(missing_ok=True)
        aside.symlink_to(relative)
        aside.replace(link)
    return link

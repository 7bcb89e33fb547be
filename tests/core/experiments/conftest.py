"""Experiments on the toy pack."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml
from rich.console import Console

from prime_core.checks.samples import DESCRIPTION
from prime_core.cli.run import run
from prime_core.datasets.write import write_dataset
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.reading import apply_setting, validate_experiment
from prime_core.experiments.running import run_experiment
from prime_core.registry import builtin
from prime_core.registry.loading import Plugins

from ..datasets.edits import edit_column, rows
from ..datasets.samples import DATA
from .toy_pack import PACK, ClimberConfig, PointMassConfig

TESTS = Path(__file__).parents[2]
TOY = """
name: toy
environment: {type: toy/point-mass}
primitives: [{type: toy/rise}]
demonstrations: {type: toy/climber}
collection: {episodes: 3, draws_per_episode: 4, other_pairs: 5}
idm: {type: toy/height}
parser: {type: dp}
policies:
  motor: {type: toy/repeats}
  calls: {type: toy/rises-to}
seeds: [1, 2]
evaluation: {trials: 3, top_checkpoints: 1, fresh_trials: 4, maximum_steps: 30}
compute: {workers: 0}
"""


@pytest.fixture(scope="module")
def toy_plugins() -> Iterator[None]:
    """Register the toy pack, and no other, for this process."""
    plugins = Plugins()
    plugins.add("core", lambda: builtin, "prime-core", "0")
    plugins.add("toy", lambda: PACK, "prime-toy", "0")
    assert [item.error for item in plugins.found] == [None, None]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("prime_core.registry.fields.load_plugins", lambda: plugins)
        yield


@pytest.fixture
def toy(tmp_path: Path, toy_plugins: None) -> Callable[..., Experiment]:
    """Make the toy experiment, with settings changed, in the test's folder."""

    def make(*settings: str, folder: Path = tmp_path / "run") -> Experiment:
        data = yaml.safe_load(TOY)
        for setting in settings:
            apply_setting(data, setting)
        return Experiment(validate_experiment(data, "toy"), folder)

    return make


@pytest.fixture
def prime_run(tmp_path: Path, toy_plugins: None) -> Callable[..., None]:
    """Call ``prime run`` on the toy experiment in this process, its folders in ``tmp_path``."""
    file = tmp_path / "toy.yaml"
    file.write_text(TOY)

    def call(
        *settings: str,
        out: Path = tmp_path,
        until: str | None = None,
        keep: bool = False,
        remake: bool = False,
    ) -> None:
        run(file, list(settings), until, out, keep, remake)

    return call


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory, toy_plugins: None) -> Path:
    """Return a folder in which the toy experiment was run; copy it before you change anything."""
    out = tmp_path_factory.mktemp("finished")
    (out / "toy.yaml").write_text(TOY)
    run(out / "toy.yaml", [], None, out)
    return out / "toy"


@pytest.fixture
def prime_command(tmp_path: Path) -> Callable[..., "subprocess.Popen[str]"]:
    """Start ``prime`` in a process of its own, where the toy pack is installed."""
    installed = tmp_path / "installed"
    info = installed / "prime_toy-0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: prime-toy\nVersion: 0\n")
    entry = "core.experiments.toy_pack:PACK"
    (info / "entry_points.txt").write_text(f"[prime]\ntoy = {entry}\n")
    (tmp_path / "toy.yaml").write_text(TOY)
    paths = os.pathsep.join((str(installed), str(TESTS)))
    prime = [sys.executable, "-c", "from prime_core.cli import main; main()"]

    def start(*arguments: str) -> "subprocess.Popen[str]":
        return subprocess.Popen(
            [*prime, *arguments],
            env={**os.environ, "PYTHONPATH": paths},
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    return start


@pytest.fixture
def climbs(tmp_path: Path) -> Path:
    """Write a data set of three climbs, of which the second holds a NaN."""
    climber, environment = ClimberConfig(count=3), PointMassConfig()
    shown = [climber.demonstrate(environment, index, 7) for index in range(3)]
    write_dataset(tmp_path / "climbs", shown, DESCRIPTION)
    first = len(shown[0].observations)

    def holed(values: np.ndarray) -> np.ndarray:
        values[first + 2, 1] = np.nan
        return values

    edit_column(tmp_path / "climbs", DATA, "action", rows(holed))
    return tmp_path / "climbs"


@pytest.fixture
def trained(toy: Callable[..., Experiment]) -> Path:
    """Return the folder of a run whose IDM is trained."""
    job = toy()
    run_experiment(job, Console(quiet=True), "idm")
    return job.folder

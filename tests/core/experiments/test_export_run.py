"""An exporter is given the demonstrations of a run one after another, or it is told why not."""

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

from prime_core.cli.export import export
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.exporter import ExporterConfig
from prime_core.errors import ConfigurationError, DatasetError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.exporting.demonstrations import export_run, read_exporter
from prime_core.files import new_file
from prime_core.hookspecs import hookimpl
from prime_core.registry import builtin
from prime_core.registry.loading import Plugins

from .toy_pack import PACK

RunToy = Callable[..., None]


class HeightsConfig(ExporterConfig):
    """Writes the heights of each demonstration as a line."""

    suffix: ClassVar[str] = ".txt"
    digits: int = 3

    def export(
        self, demonstrations: Iterable[Demonstration], environment: EnvironmentConfig, target: Path
    ) -> None:
        with new_file(target) as partial, partial.open("w") as file:
            for shown in demonstrations:
                heights = shown.observations.gripper_position[:, 2]
                print(*(f"{height:.{self.digits}f}" for height in heights), file=file)


@hookimpl
def register_exporters(register: Callable[..., None]) -> None:
    register("toy/heights", HeightsConfig)


@pytest.fixture(autouse=True)
def plugins(toy_plugins: None, monkeypatch: pytest.MonkeyPatch) -> None:
    found = Plugins()
    found.add("core", lambda: builtin, "prime-core", "0")
    pack = SimpleNamespace(**{**vars(PACK), "register_exporters": register_exporters})
    found.add("toy", lambda: pack, "prime-toy", "0")
    monkeypatch.setattr("prime_core.registry.fields.load_plugins", lambda: found)


def as_it_is(each: Iterable[Demonstration], count: int) -> Iterable[Demonstration]:
    return each


def heights(path: Path) -> list[list[float]]:
    return [[float(word) for word in line.split()] for line in path.read_text().splitlines()]


def test_demonstrations_are_written_in_order_and_counted(
    tmp_path: Path, prime_run: RunToy, toy: Callable[..., Experiment]
) -> None:
    changes = ("demonstrations.count=3", "demonstrations.broken=[1]")
    prime_run(*changes, until="demonstrations")
    told: list[int] = []

    def shown(each: Iterable[Demonstration], count: int) -> Iterator[Demonstration]:
        for one in each:
            told.append(count)
            yield one

    exporter = read_exporter("toy/heights", ["digits=6"])
    done = export_run(tmp_path / "toy", exporter, tmp_path / "new" / "a.txt", shown)
    assert told == [2, 2]
    wanted = toy(*changes, folder=tmp_path / "toy").demonstrations.load()
    assert [*wanted] == ["0", "2"]
    found = heights(tmp_path / "new" / "a.txt")
    for line, one in zip(found, wanted.values(), strict=True):
        np.testing.assert_allclose(line, one.observations.gripper_position[:, 2], atol=1e-6)
    assert done.target == tmp_path / "new" / "a.txt"
    assert done.demonstrations == 2
    assert done.actions == sum(len(line) - 1 for line in found)


def test_the_command_writes_beside_the_run_and_not_twice(
    tmp_path: Path, prime_run: RunToy, capsys: pytest.CaptureFixture[str]
) -> None:
    prime_run(until="demonstrations")
    capsys.readouterr()
    export(tmp_path / "toy", "toy/heights")
    target = tmp_path / "toy-toy-heights.txt"
    lines = heights(target)
    actions = sum(len(line) - 1 for line in lines)
    said = capsys.readouterr().out
    assert f"2 demonstrations, {actions} motor actions.\nWritten to {target}" in said
    before = target.read_bytes()
    with pytest.raises(DatasetError) as caught:
        export(tmp_path / "toy", "toy/heights", set_=["digits=1"])
    assert str(caught.value) == f"{target}: is there already: choose another place with --out"
    assert target.read_bytes() == before


def test_a_run_without_demonstrations_is_refused(tmp_path: Path, prime_run: RunToy) -> None:
    prime_run(until="demonstrations")
    file = tmp_path / "toy" / "experiment.yaml"
    with pytest.raises(ConfigurationError, match=r"there is no experiment\.yaml in it"):
        export(tmp_path, "toy/heights")
    for stage in (tmp_path / "toy" / "stages").iterdir():
        stage.rename(tmp_path / stage.name)
    assert file.is_file()
    with pytest.raises(ConfigurationError) as caught:
        export(tmp_path / "toy", "toy/heights")
    assert str(caught.value) == (
        f"{tmp_path / 'toy'}: 2 of its 2 demonstrations are not made yet: prime run ... --until "
        "demonstrations makes them"
    )
    assert not (tmp_path / "toy-toy-heights.txt").exists()


def test_wrong_formats_and_settings_are_told() -> None:
    for name, settings, text in (
        (
            "toy/hights",
            [],
            "--to toy/hights: no exporter is registered as 'toy/hights'. Did you mean "
            "'toy/heights'? Registered: toy/heights.",
        ),
        (
            "toy/heights",
            ["digit=1"],
            "--to toy/heights: unknown key 'digit': did you mean 'digits'? There are: digits",
        ),
        ("toy/heights", ["digits=many"], "--to toy/heights: digits: found 'many': input should be"),
        ("toy/heights", ["digits"], "--set digits: it must be key=value"),
    ):
        with pytest.raises(ConfigurationError) as caught:
            read_exporter(name, settings)
        assert str(caught.value).startswith(text)

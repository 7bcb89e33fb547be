"""Where parsed data sets go."""

from pathlib import Path

import pytest

from prime_core.errors import ConfigurationError
from prime_core.experiments.parse_dataset import beside


def test_no_two_sources_are_parsed_into_one_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ("set", "set.v1.0", "set.v1.1", "demo.hdf5", "demo.h5", "demo", ".hidden")
    found = {beside(tmp_path / name, "parsed") for name in names}
    assert found == {tmp_path / f"{name}-parsed" for name in names}
    inner = tmp_path / "set.v1.0" / "data"
    inner.mkdir(parents=True)
    monkeypatch.chdir(inner)
    assert beside(Path(), "parsed") == inner.with_name("data-parsed")
    assert beside(Path(".."), "parsed") == tmp_path / "set.v1.0-parsed"
    with pytest.raises(ConfigurationError, match="nothing can lie beside it: say --out FOLDER"):
        beside(Path("/"), "parsed")

from pathlib import Path
from typing import Annotated, Any

import pytest
from pydantic import TypeAdapter, ValidationError

from prime_core.collection.settings import CollectionConfig
from prime_core.configuration import (
    Config,
    Count,
    LocalPath,
    PositiveRange,
    Range,
    Seed,
    StepRange,
    within,
)


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        (Range, (0.3, 0.1), r"0 <= low <= high; found \[0.3, 0.1\]"),
        (Range, (-0.1, 0.1), r"0 <= low <= high; found \[-0.1, 0.1\]"),
        (PositiveRange, (0.0, 0.1), r"are above 0; found \[0.0, 0.1\]"),
        (StepRange, (500, 150), r"0 <= low <= high; found \[500, 150\]"),
        (StepRange, (0, 150), "greater than 0"),
    ],
)
def test_a_range_without_sense_is_refused(
    kind: type, value: tuple[float, float], text: str
) -> None:
    with pytest.raises(ValidationError, match=text):
        TypeAdapter(kind).validate_python(value)


def test_a_range_may_be_one_number() -> None:
    assert TypeAdapter(PositiveRange).validate_python([0.6, 0.6]) == (0.6, 0.6)


@pytest.mark.parametrize("key", ["atomic_steps", "other_steps"])
def test_lengths_to_collect_are_ranges(key: str) -> None:
    with pytest.raises(ValidationError, match=r"0 <= low <= high; found \[60, 20\]"):
        CollectionConfig.model_validate({key: [60, 20]})


class Numbers(Config):
    """What packs may write: no bound of its own but those of its kinds."""

    number: int = 1
    share: float | None = 0.5
    many: tuple[Count, ...] = ()
    named: dict[str, Seed] = {}  # noqa: RUF012
    switch: bool = True
    either: int | bool = 1
    near: Annotated[Range, within(0, 2)] = (0, 1)
    path: LocalPath = Path("/")


@pytest.mark.parametrize(
    ("key", "value", "place"),
    [
        ("number", True, ("number",)),
        ("share", False, ("share",)),
        ("many", [1, True], ("many", 1)),
        ("named", {"a": True}, ("named", "a")),
        ("near", [0, True], ("near", 1)),
        ("share", float("nan"), ("share",)),
        ("share", float("inf"), ("share",)),
        ("share", "inf", ("share",)),
        ("many", [10**9], ("many", 0)),
        ("many", [0], ("many", 0)),
        ("named", {"a": -1}, ("named", "a")),
        ("named", {"a": 2**32}, ("named", "a")),
        ("near", [0, 3], ("near",)),
    ],
)
def test_a_number_without_sense_is_refused_where_it_stands(
    key: str, value: Any, place: tuple[Any, ...]
) -> None:
    with pytest.raises(ValidationError) as raised:
        Numbers.model_validate({key: value})
    assert [item["loc"] for item in raised.value.errors()] == [place]


def test_true_and_false_are_what_a_switch_takes() -> None:
    assert Numbers(switch=False, either=True) == Numbers.model_validate(
        {"switch": "no", "either": True}
    )


def test_paths_are_expanded_and_held_from_the_root(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("DATA", "set.v1")
    (tmp_path / "link").symlink_to("set.v1")
    for text in ("set.v1", "./a/../set.v1/", "~/set.v1", "$DATA", "${HOME}/$DATA", "link"):
        read = Numbers.model_validate({"path": text})
        assert read.path == tmp_path / "set.v1"
        assert Numbers.model_validate(read.model_dump(mode="json")) == read


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("", "a path must name a file or folder"),
        ("  ", "a path must name a file or folder"),
        ("~nobody-here/set", "which is no path: Could not determine home"),
        ("a\0b", "which is no path: embedded null"),
        ("loop", "which is no path: Symlink loop"),
    ],
)
def test_what_is_no_path_is_refused(
    path: str, text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(ValidationError, match=text):
        Numbers.model_validate({"path": path})

"""YAML as people write it: the core schema of YAML 1.2, merge keys, and every mistake's place."""

import math
from pathlib import Path
from typing import Any

import pytest

from prime_core.errors import ConfigurationError
from prime_core.experiments.yaml_text import dump_yaml, load_yaml, read_mapping


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("010", 10),
        ("-07", -7),
        ("+3", 3),
        ("0o17", 15),
        ("0x1F", 31),
        ("1e-4", 1e-4),
        ("1.e3", 1000.0),
        (".5", 0.5),
        ("5.", 5.0),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("True", True),
        ("FALSE", False),
        ("~", None),
        ("null", None),
        ("", None),
        *[(word, word) for word in ("no", "No", "yes", "on", "OFF", "y", "n", "tRUE", "nULL")],
        *[(word, word) for word in ("1:30", "0b11", "1_000", "2020-01-01", "=", "<<", "1e", ".")],
        ("'5'", "5"),
        ("!!str 010", "010"),
        ("!!int '7'", 7),
        ("!!float 1", 1.0),
    ],
)
def test_scalars_are_those_of_the_core_schema(text: str, value: Any) -> None:
    found = load_yaml(f"key: {text}", "FILE")["key"]
    assert (type(found), found) == (type(value), value)
    assert math.isnan(load_yaml(".nan", "FILE"))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("{a: &p {x: 1}, b: {<<: *p, y: 2}}", {"a": {"x": 1}, "b": {"x": 1, "y": 2}}),
        ("{a: &p {x: 1}, b: {y: 2, x: 3, <<: *p}}", {"a": {"x": 1}, "b": {"x": 3, "y": 2}}),
        ("{<<: [{x: 1}, {x: 2, y: 3}]}", {"x": 1, "y": 3}),
        ("{a: &p {<<: {x: 1}, y: 2}, b: &q {<<: *p}, c: {<<: *q, x: 4}}", None),
        ("{no: 1, '<<': 2, 1: 3}", {"no": 1, "<<": 2, 1: 3}),
    ],
)
def test_merge_keys_give_way_to_a_mapping_s_own(text: str, value: Any) -> None:
    found = load_yaml(text, "FILE")
    if value is None:
        assert found["b"] == {"x": 1, "y": 2}
        assert found["c"] == {"x": 4, "y": 2}
    else:
        assert found == value


def test_what_an_alias_stands_for_is_changed_alone() -> None:
    found = load_yaml("{a: &p {x: [1]}, b: *p}", "FILE")
    found["a"]["x"].append(2)
    assert found["b"] == {"x": [1]}


BOMB = "\n".join(
    ["a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    + [f"{new}: &{new} [{', '.join([f'*{old}'] * 10)}]" for old, new in zip("abcd", "bcde")]  # noqa: B905
)


@pytest.mark.parametrize(
    ("text", "mistake"),
    [
        ("a: 1\nb: 2\na: 3", "FILE, line 3, column 1: not YAML: the key 'a' stands twice"),
        ("{a: 1, b: {c: 1, c: 2}}", "FILE, line 1, column 18: not YAML: the key 'c' stands"),
        ("a: &p {x: 1}\n<<: *p\n<<: *p", "FILE, line 3, column 1: not YAML: the key '<<' stands"),
        ("a: &x [*x]", "FILE, line 1, column 4: not YAML: a list or mapping that holds itself"),
        ("a: &x {<<: *x}", "FILE, line 1, column 4: not YAML: a list or mapping that holds itself"),
        ("<<: 3", "FILE, line 1, column 5: not YAML: '<<' takes a mapping or a list of mappings"),
        ("? [1]\n: 2", "FILE, line 1, column 3: not YAML: a list or mapping as a key"),
        ("a: !!int x", "FILE, line 1, column 4: not YAML: 'x' is no int"),
        ("a: !!bool yes", "FILE, line 1, column 4: not YAML: 'yes' is no bool"),
        ("a: !!python/name:os.system ''", "line 1, column 4: not YAML: unknown tag 'tag:yaml.org,"),
        ("a: !mine {}", "FILE, line 1, column 4: not YAML: unknown tag '!mine'"),
        (f"a: {'9' * 5000}", "FILE, line 1, column 4: not YAML: an integer of 5000 digits"),
        ("[" * 3000, "FILE: lists or mappings lie too deep in each other"),
        ("a: b: c", "FILE, line 1, column 5: not YAML: mapping values are not allowed here"),
        ("--- a\n--- b", "FILE, line 2, column 1: not YAML: a second document begins here (---)"),
        ("a:\n\tb: 1", "FILE, line 2, column 1: not YAML: a tab where only spaces can stand"),
        ("a: \x01", "FILE: not YAML: unacceptable character #x0001: special characters are not"),
        (BOMB, "not YAML: more than 100000 values, those of aliases included"),
    ],
)
def test_a_mistake_is_one_line_with_its_place(text: str, mistake: str) -> None:
    with pytest.raises(ConfigurationError) as raised:
        load_yaml(text, "FILE")
    assert mistake in str(raised.value)
    assert "\n" not in str(raised.value)


TEXTS = ("no", "1e3", "0o17", "010", "1:30", ".5e3", "null", "~", "", "<<", "2020-01-01", "a: b")


@pytest.mark.parametrize(
    "value", [*TEXTS, "é", 1e-5, 1e300, math.inf, True, None, 7, [1, "2"], {"no": {"1": []}}]
)
def test_what_is_written_is_read_back(value: Any) -> None:
    assert load_yaml(dump_yaml({"key": value, "no": 1}), "FILE") == {"key": value, "no": 1}


def test_a_file_that_holds_no_mapping_is_told(tmp_path: Path) -> None:
    path = tmp_path / "experiment.yaml"
    for content, text in (
        (b"", "found nothing at the top"),
        (b"- 1", "found list at the top"),
        (b"\xff\xfe", "cannot be read as text"),
    ):
        path.write_bytes(content)
        with pytest.raises(ConfigurationError, match=text):
            read_mapping(path)
    with pytest.raises(ConfigurationError, match="cannot be read as text"):
        read_mapping(tmp_path)
    path.write_bytes(b"\xef\xbb\xbfname: lift")  # with the mark that some editors begin with
    assert read_mapping(path) == {"name": "lift"}

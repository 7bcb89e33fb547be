"""Reads and writes YAML: the core schema of YAML 1.2, with merge keys.

PyYAML alone reads YAML 1.1, where ``no`` is false, ``010`` is eight, ``1:30`` is ninety and
``1e-4`` is text.
"""

import re
from pathlib import Path
from typing import Any

import yaml

from prime_core.errors import ConfigurationError

MOST_VALUES = 100_000
"""In a file, aliases written out: a few lines of aliases of aliases stand for billions."""

_TAG = "tag:yaml.org,2002:"
_CONSTANTS: dict[str, dict[str, Any]] = {
    "null": {word: None for word in ("null", "Null", "NULL", "~", "")},
    "bool": {word: word[0] in "tT" for word in ["true", "True", "TRUE", "false", "False", "FALSE"]},
}
_NUMBERS = {
    "int": re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+"),
    "float": re.compile(
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"
        r"|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"
    ),
}
_BASES = {"0o": 8, "0x": 16}
_PATTERNS = {
    **{kind: re.compile("|".join(map(re.escape, words))) for kind, words in _CONSTANTS.items()},
    **_NUMBERS,  # the integers first: all of them are floats, too
}


class _Loader(yaml.BaseLoader):
    """Tells what kind each scalar is."""


class _Dumper(yaml.SafeDumper):
    """Quotes text that YAML 1.1 or 1.2 would read as something else."""


for _kind, _pattern in _PATTERNS.items():
    for _class in (_Loader, _Dumper):
        _class.add_implicit_resolver(_TAG + _kind, re.compile(f"^(?:{_pattern.pattern})$"), None)
_Loader.add_implicit_resolver(_TAG + "merge", re.compile("^<<$"), ["<"])


def read_mapping(path: Path, what: str = "an experiment") -> dict[str, Any]:
    """Read a YAML file that holds a mapping.

    Args:
        path: The file.
        what: What it should be, for people.

    Raises:
        ConfigurationError: If it cannot be read, is no YAML, or holds something else.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ConfigurationError(f"{path}: there is no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"{path}: cannot be read as text: {error}") from None
    data = load_yaml(text, str(path))
    if not isinstance(data, dict):
        found = "nothing" if data is None else type(data).__name__
        raise ConfigurationError(
            f"{path}: found {found} at the top: {what} is a mapping of keys, such as 'name: lift'"
        )
    return data


def load_yaml(text: str, source: str) -> Any:
    """Return what a YAML text holds, as plain data; no two places share a list or mapping.

    Args:
        text: One document, or nothing.
        source: What the error text calls it.

    Raises:
        ConfigurationError: If it is no YAML; the text names line and column.
    """
    try:
        node = yaml.compose(text, Loader=_Loader)
        return None if node is None else _Values().of(node)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        problem = error.problem or error.context
        if "'\\t'" in str(problem):
            problem = "a tab where only spaces can stand: indent with spaces"
        elif "another document" in str(problem):
            problem = "a second document begins here (---): a file holds one experiment"
        raise ConfigurationError(f"{source}{where}: not YAML: {problem}") from None
    except yaml.YAMLError as error:
        text = " ".join(str(error).split())
        raise ConfigurationError(f"{source}: not YAML: {text}") from None
    except RecursionError:
        raise ConfigurationError(
            f"{source}: lists or mappings lie too deep in each other"
        ) from None


def dump_yaml(data: Any) -> str:
    """Return plain data as YAML, keys in the order that they have."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False)


class _Values:
    """Makes values of nodes."""

    def __init__(self) -> None:
        self._count = 0
        self._around: list[yaml.Node] = []

    def of(self, node: yaml.Node) -> Any:
        self._count += 1
        if self._count > MOST_VALUES:
            raise _mistake(node, f"more than {MOST_VALUES} values, those of aliases included")
        if isinstance(node, yaml.ScalarNode):
            return _scalar(node)
        if any(node is outer for outer in self._around):
            raise _mistake(node, "a list or mapping that holds itself")
        kind = "seq" if isinstance(node, yaml.SequenceNode) else "map"
        if node.tag != _TAG + kind:
            raise _mistake(node, f"unknown tag {node.tag!r}")
        self._around.append(node)
        try:
            if kind == "seq":
                return [self.of(item) for item in node.value]
            return self._mapping(node)
        finally:
            self._around.pop()

    def _mapping(self, node: yaml.Node) -> dict[Any, Any]:
        own: dict[Any, Any] = {}
        merged: dict[Any, Any] | None = None
        for key_node, value in node.value:
            if key_node.tag == _TAG + "merge":
                if merged is not None:
                    raise _mistake(key_node, "the key '<<' stands twice: give it a list")
                merged = self._merged(value)
                continue
            key = self.of(key_node)
            if isinstance(key, (list, dict)):
                raise _mistake(key_node, "a list or mapping as a key")
            if key in own:
                raise _mistake(key_node, f"the key {key!r} stands twice")
            own[key] = self.of(value)
        return {**(merged or {}), **own}

    def _merged(self, node: yaml.Node) -> dict[Any, Any]:
        sources = node.value if isinstance(node, yaml.SequenceNode) else [node]
        merged: dict[Any, Any] = {}
        for source in sources:
            if not isinstance(source, yaml.MappingNode):
                raise _mistake(source, "'<<' takes a mapping or a list of mappings")
            merged = {**self.of(source), **merged}  # the first that has a key wins
        return merged


def _scalar(node: yaml.ScalarNode) -> Any:
    kind, text = node.tag.removeprefix(_TAG), str(node.value)
    if kind in ("str", "merge"):
        return text
    if kind not in _PATTERNS:
        raise _mistake(node, f"unknown tag {node.tag!r}")
    if not _PATTERNS[kind].fullmatch(text):
        raise _mistake(node, f"{text!r} is no {kind}")
    if kind in _CONSTANTS:
        return _CONSTANTS[kind][text]
    if kind == "float":
        return float(text.replace(".", "", 1) if text[-1].isalpha() else text)
    base = _BASES.get(text[:2], 10)
    try:
        return int(text if base == 10 else text[2:], base)
    except ValueError:  # Python reads integers of some thousand digits at most
        raise _mistake(node, f"an integer of {len(text)} digits") from None


def _mistake(node: yaml.Node, problem: str) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)

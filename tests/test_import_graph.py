"""Circles of imports, and imports of what is not public, are found."""

from pathlib import Path

import pytest

from .import_graph import circle_in, graph_of, not_public


def test_a_circle_is_found_inside_functions_too_and_not_among_types(tmp_path: Path) -> None:
    package = tmp_path / "pack"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "one.py").write_text("def late():\n    from pack.two import thing\n")
    (package / "two.py").write_text("import pack.one\nthing = 1\n")
    assert set(circle_in(graph_of(package))) == {"pack.one", "pack.two"}
    assert circle_in(graph_of(package, in_functions=False)) == []
    typed = tmp_path / "typed"
    typed.mkdir()
    (typed / "one.py").write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from typed.two import thing\n"
    )
    (typed / "two.py").write_text("from typed import one\nthing = 1\n")
    assert graph_of(typed) == {"typed.one": set(), "typed.two": {"typed.one"}}


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("from prime_core.execution.motions import step", ["prime_core.execution.motions.step"]),
        ("import prime_core.registry.loading", ["prime_core.registry.loading."]),
        ("from prime_core import registry", ["prime_core.registry"]),
        ("from prime_core.checks import check_idm", ["prime_core.checks.check_idm"]),
        ("def late():\n    from prime_core.cli import main", ["prime_core.cli.main"]),
        ("from prime_core import Scene, hookspecs", []),
        ("from prime_core.contracts.scene import Scene", []),
        ("from prime_core.seeds import generator_of", []),
    ],
)
def test_what_is_not_public_is_found(tmp_path: Path, line: str, found: list[str]) -> None:
    path = tmp_path / "pack.py"
    path.write_text(line)
    assert not_public(path, ("prime_core", "prime_core.seeds", "prime_core.hookspecs")) == found

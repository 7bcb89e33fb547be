"""The plugin tutorial shows the files that are there, and all hooks and checks."""

import re
from pathlib import Path

import pytest

import prime_core.checks
from prime_core import hookspecs

DOCS = Path(__file__).parents[1] / "docs"
PAGE = (DOCS / "write_a_plugin.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r'```\w+ title="([^"]+)"\n(.*?)\n```', PAGE, flags=re.DOTALL)
HOOKS = [name for name in vars(hookspecs) if name.startswith("register_")]
CHECKS = [
    name
    for name in prime_core.checks.__all__
    if name.startswith("check_") and name not in ("check_scene", "check_description")
]


@pytest.mark.parametrize(("name", "text"), BLOCKS)
def test_a_block_that_names_a_file_is_part_of_it(name: str, text: str) -> None:
    file = DOCS / "examples" / "hello_primitive" / name
    assert text in file.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", sorted({name for name, _ in BLOCKS}))
def test_the_blocks_show_each_file_in_full(name: str) -> None:
    rest = (DOCS / "examples" / "hello_primitive" / name).read_text(encoding="utf-8")
    for block_name, text in BLOCKS:
        if block_name == name:
            rest = rest.replace(text, "")
    assert not rest.strip()


@pytest.mark.parametrize("name", [*HOOKS, *CHECKS])
def test_every_hook_and_check_is_named(name: str) -> None:
    assert f"`{name}`" in PAGE


def test_links_lead_somewhere() -> None:
    links = re.findall(r"\]\((?!https://)([^)#]+)\)", PAGE)
    assert links
    assert [link for link in links if not (DOCS / link).exists()] == []

"""Which part of the pack may import which; no part imports another that imports it."""

import ast
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import prime_envs_robosuite

PACK = "prime_envs_robosuite"
FOLDER = Path(prime_envs_robosuite.__path__[0])
ORDER = (
    {"mujoco_import"},
    {"simulation"},
    {"pictures"},
    {"tasks"},
    {"robosuite_tasks"},
    {"environment", "config", "recorder"},
    {"demonstrators", "recordings"},
    {PACK},
)
"""Each imports what stands before it, and itself; of those side by side only the files at the top
import each other."""


def modules() -> dict[str, Path]:
    """Return all modules of the pack by name."""
    found = {}
    for path in sorted(FOLDER.rglob("*.py")):
        parts = path.relative_to(FOLDER.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def statements(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield all that runs, inside functions too; not what is there for type checkers alone."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        yield node
        yield from statements(node)


def imported() -> dict[str, set[str]]:
    """Return which modules of the pack each imports."""
    known = modules()
    found: dict[str, set[str]] = {name: set() for name in known}
    for name, path in known.items():
        for node in statements(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module:
                full = [f"{node.module}.{alias.name}" for alias in node.names]
                found[name] |= {item if item in known else node.module for item in full}
        found[name] &= known.keys()
    return found


def room(module: str) -> str:
    """Return the folder, or the file at the top, that a module is in."""
    return PACK if module == PACK else module.split(".")[1]


def test_rooms_import_only_rooms_before_them() -> None:
    rank = {name: number for number, names in enumerate(ORDER) for name in names}
    assert {room(name) for name in modules()} == rank.keys()
    links = [(one, other) for one, others in imported().items() for other in others]
    assert len(links) > 50
    for one, other in links:
        beside = rank[room(one)] == rank[room(other)] == rank["environment"]
        before = rank[room(other)] < rank[room(one)]
        assert before or beside or room(one) == room(other), f"{one} imports {other}"


def test_no_module_imports_one_that_imports_it() -> None:
    assert len(list(TopologicalSorter(imported()).static_order())) == len(modules())


def test_each_room_says_what_is_in_it_and_is_neither_empty_nor_full() -> None:
    for folder in [path for path in FOLDER.iterdir() if path.is_dir() and path.name[0] != "_"]:
        files = [path for path in folder.glob("*.py") if path.name != "__init__.py"]
        assert 2 <= len(files) <= 12, folder
        said = ast.get_docstring(ast.parse((folder / "__init__.py").read_text()))
        assert said is not None
        assert len(said) > 80, folder

"""Rules of the code base that no type checker knows."""

import ast
import importlib
import pkgutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import prime_core

ROOT = Path(__file__).parents[1]
PLUGINS = ("prime_envs_robosuite", "prime_policies", "prime_primitives_scripted")
HEAVY = ("torch", "mujoco", "robosuite", "lerobot", "mink", "numba", "pyarrow", "matplotlib", "av")
MAXIMUM_LINES = 300
MAXIMUM_FUNCTION_LINES = 60


def sources() -> Iterator[Path]:
    yield from sorted((ROOT / "prime_core").rglob("*.py"))
    yield from sorted((ROOT / "plugins").glob("*/src/**/*.py"))


def imports(path: Path) -> set[str]:
    """Return the top-level names of all modules that a file imports anywhere."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found.update(alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.add(node.module.split(".")[0])
    return found


def loaded_after(*arguments: str) -> set[str]:
    """Return the top-level modules that a fresh process has loaded."""
    done = subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return set(done.stdout.split("MODULES", 1)[1].split())


SHOW = "import sys; print('MODULES', *{name.split('.')[0] for name in sys.modules})"


@pytest.mark.parametrize(
    "code",
    [
        "import prime_core",
        *[f"import {name}" for name in PLUGINS],
        "import sys, atexit\n"
        "from prime_core.cli import main\n"
        "sys.argv = ['prime', '--help']\n"
        "try: main()\n"
        "except SystemExit: pass",
    ],
)
def test_importing_and_asking_for_help_load_nothing_heavy(code: str) -> None:
    assert not loaded_after("-c", f"{code}\n{SHOW}") & set(HEAVY)


def test_the_core_imports_no_plugin_and_no_simulator() -> None:
    for path in (ROOT / "prime_core").rglob("*.py"):
        forbidden = {"torch", "mujoco", "robosuite", "lerobot", "mink", *PLUGINS}
        assert not imports(path) & forbidden, path


def test_plugins_import_the_core_and_never_each_other() -> None:
    for package in PLUGINS:
        (folder,) = (ROOT / "plugins").glob(f"*/src/{package}")
        for path in folder.rglob("*.py"):
            assert not imports(path) & (set(PLUGINS) - {package}), path


def test_files_and_functions_stay_short() -> None:
    for path in sources():
        text = path.read_text()
        assert text.count("\n") <= MAXIMUM_LINES, path
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef):
                lines = (node.end_lineno or node.lineno) - node.lineno
                assert lines <= MAXIMUM_FUNCTION_LINES, f"{path}: {node.name}"


def test_the_public_names_are_sorted_and_resolve() -> None:
    assert list(prime_core.__all__) == sorted(prime_core.__all__)
    for name in prime_core.__all__:
        assert getattr(prime_core, name) is not None


def test_every_module_of_the_core_can_be_imported_alone() -> None:
    for module in pkgutil.walk_packages(prime_core.__path__, "prime_core."):
        importlib.import_module(module.name)

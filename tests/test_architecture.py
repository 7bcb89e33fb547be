"""Rules of the code base that no type checker knows."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import prime_core

from .import_graph import circle_in, graph_of, imported, not_public

ROOT = Path(__file__).parents[1]
CORE = ROOT / "prime_core"
PACKS = {path.name: path for path in sorted((ROOT / "plugins").glob("*/src/*")) if path.is_dir()}
EXAMPLE = ROOT / "docs" / "examples" / "hello_primitive"
HEAVY = (
    "torch",
    "mujoco",
    "robosuite",
    "lerobot",
    "mink",
    "numba",
    "pyarrow",
    "matplotlib",
    "av",
    "PIL",
)
MAXIMUM_LINES = 300
MAXIMUM_FUNCTION_LINES = 60
MAXIMUM_FILES = 15
MAXIMUM_FILES_AT_THE_TOP = 8

ORDER = (
    ("",),  # the files at the top of prime_core, but for its __init__
    ("contracts",),
    ("affordances",),
    ("datasets.columns",),
    ("datasets.files",),
    ("datasets.images",),
    ("parsing", "datasets"),
    ("datasets.annotation",),
    ("execution",),
    ("collection",),
    ("learning",),
    ("reporting",),
    ("checks",),
    ("registry",),
    ("deployment",),
    ("experiments.run_folder",),
    ("experiments.stages",),
    ("experiments.stages.outputs",),
    ("experiments",),
    ("experiments.conversion",),
    ("experiments.results",),
    ("experiments.exporting",),
    ("cli",),
)
"""The folders of prime_core: each may import those above it; two in a line need not each other."""

KNOW_TORCH = (CORE / "contracts" / "images.py", CORE / "checks" / "encoder.py")
"""Encoders are torch modules: torch is named for type checkers, and used inside functions."""

ONLY_IN_FUNCTIONS = {"registry": ("parsing", "datasets")}
"""What the registry registers is imported once somebody asks for it."""

PUBLIC = (
    "prime_core",
    "prime_core.hookspecs",
    "prime_core.contracts",
    "prime_core.affordances.goals",
    "prime_core.affordances.outcomes",
    "prime_core.affordances.pose_space",
    "prime_core.affordances.prior",
    "prime_core.arrays",
    "prime_core.configuration",
    "prime_core.errors",
    "prime_core.files",
    "prime_core.learning.model_card",
    "prime_core.learning.parameter_layout",
    "prime_core.learning.scene_features",
    "prime_core.registry.fields",
    "prime_core.rotations",
    "prime_core.seeds",
)
"""What a pack may import, with all modules of the contracts."""

PUBLIC_IN_TESTS = (*PUBLIC, "prime_core.checks")


def sources() -> Iterator[Path]:
    yield from sorted(CORE.rglob("*.py"))
    for folder in PACKS.values():
        yield from sorted(folder.rglob("*.py"))


def folder_of(module: str) -> str:
    """Return which folder of `ORDER` a module of the core lies in."""
    parts = module.split(".")[1:]
    inner = [folder for line in ORDER for folder in line if folder]
    for length in range(len(parts), 0, -1):
        if ".".join(parts[:length]) in inner:
            return ".".join(parts[:length])
    return ""


def imports(path: Path) -> set[str]:
    """Return the top-level names of all modules that a file imports anywhere."""
    return {module.split(".")[0] for module, _ in imported(path, for_types=True)}


def loaded_after(*arguments: str) -> set[str]:
    """Return the top-level modules that a fresh process has loaded."""
    done = subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=True, cwd=ROOT
    )
    # Once prime has ended, standard output is closed to all others.
    return set((done.stdout + done.stderr).split("MODULES", 1)[1].split())


SHOW = "import sys; print('MODULES', *{name.split('.')[0] for name in sys.modules})"


@pytest.mark.parametrize(
    "code",
    [
        "import prime_core",
        *[f"import {name}" for name in PACKS],
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
    for path in CORE.rglob("*.py"):
        forbidden = {"torch", "mujoco", "robosuite", "lerobot", "mink", *PACKS}
        if path in KNOW_TORCH:
            forbidden.remove("torch")
            assert "torch" not in {name for name, _ in imported(path, in_functions=False)}
        assert not imports(path) & forbidden, path


def test_plugins_import_the_core_and_never_each_other() -> None:
    assert len(PACKS) >= 3
    for package, folder in PACKS.items():
        for path in folder.rglob("*.py"):
            assert not imports(path) & (set(PACKS) - {package}), path


def test_the_order_names_every_folder_of_the_core() -> None:
    found = {
        ".".join(path.parent.relative_to(CORE).parts)
        for path in CORE.rglob("*.py")
        if path.name != "__init__.py"
    }
    assert found == {folder for line in ORDER for folder in line}


def upward_imports(*, in_functions: bool) -> list[str]:
    rank = {folder: number for number, line in enumerate(ORDER) for folder in line}
    return [
        f"{module} imports {target}"
        for module, targets in graph_of(CORE, in_functions=in_functions).items()
        for target in sorted(targets)
        if module != "prime_core"
        and folder_of(module) != folder_of(target)
        and rank[folder_of(target)] >= rank[folder_of(module)]
    ]


def test_folders_of_the_core_import_those_above_them_only() -> None:
    assert upward_imports(in_functions=True) == []


@pytest.mark.parametrize("folder", ONLY_IN_FUNCTIONS)
def test_what_is_imported_in_functions_only(folder: str) -> None:
    graph = graph_of(CORE, in_functions=False)
    found = {
        folder_of(target)
        for module, targets in graph.items()
        if folder_of(module) == folder
        for target in targets
    }
    assert not found & set(ONLY_IN_FUNCTIONS[folder])


@pytest.mark.parametrize("package", ["prime_core", *PACKS])
def test_no_modules_import_each_other_in_a_circle(package: str) -> None:
    graph = graph_of(PACKS.get(package, CORE))
    assert len(graph) > 5
    assert circle_in(graph) == []


def test_only_the_public_names_are_imported_by_their_names_as_text() -> None:
    found = [path for path in sources() if "import_module(" in path.read_text()]
    assert found == [CORE / "__init__.py"]


def test_folders_of_the_core_hold_a_few_files_each() -> None:
    for init in CORE.rglob("__init__.py"):
        files = [path for path in init.parent.glob("*.py") if path != init]
        assert 2 <= len(files) <= MAXIMUM_FILES, init.parent
    packages = {init.parent for init in CORE.rglob("__init__.py")}
    assert {path.parent for path in CORE.rglob("*.py")} == packages


def test_few_files_lie_at_the_top_of_the_core() -> None:
    names = [path.name for path in CORE.iterdir() if path.is_file()]
    assert len([name for name in names if name.endswith(".py")]) <= MAXIMUM_FILES_AT_THE_TOP
    assert {name for name in names if not name.endswith(".py")} == {"py.typed"}


@pytest.mark.parametrize(
    "init", sorted(CORE.rglob("__init__.py")), ids=lambda path: path.parent.name
)
def test_every_folder_of_the_core_says_what_lives_there_and_what_goes_there(init: Path) -> None:
    text = ast.get_docstring(ast.parse(init.read_text())) or ""
    assert len(re.findall(r"[.!?](?=\s|$)|:$", text, flags=re.MULTILINE)) >= 2, text


@pytest.mark.parametrize("package", PACKS)
def test_packs_import_what_is_public_of_the_core_and_no_more(package: str) -> None:
    for path in sorted(PACKS[package].rglob("*.py")):
        assert not_public(path, PUBLIC) == [], path


def test_the_example_pack_takes_two_files_and_imports_what_is_public() -> None:
    pack = EXAMPLE / "hello_primitive.py"
    assert not_public(pack, PUBLIC) == []
    assert not_public(EXAMPLE / "test_hello_primitive.py", PUBLIC_IN_TESTS) == []
    assert {path.name for path in EXAMPLE.iterdir() if path.is_file()} == {
        "hello_primitive.py",
        "pyproject.toml",
        "lift_by_hello.yaml",
        "test_hello_primitive.py",
    }


def test_the_page_on_plugins_lists_what_is_public() -> None:
    page = (ROOT / "docs" / "write_a_plugin.md").read_text(encoding="utf-8")
    for module in PUBLIC_IN_TESTS:
        assert f"`{module}`" in page or f"`{module.removeprefix('prime_core.')}`" in page, module


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


ALONE = """
import importlib, os, pkgutil, sys
import prime_core
modules = pkgutil.walk_packages(prime_core.__path__, "prime_core.")
names = ["prime_core", *(item.name for item in modules)]
for name in names:
    importlib.import_module(name)  # what it needs from elsewhere is there from now on
for name in [name for name in sys.modules if name.partition(".")[0] == "prime_core"]:
    del sys.modules[name]
failed = []
for name in names:
    child = os.fork()
    if not child:
        try:
            importlib.import_module(name)
        except BaseException:
            os._exit(1)
        os._exit(0)
    if os.waitpid(child, 0)[1]:
        failed.append(name)
print("MODULES", len(names), *failed)
"""


def test_every_module_of_the_core_can_be_imported_alone() -> None:
    """Whichever comes first: a circle of imports breaks from one end only."""
    done = subprocess.run(
        [sys.executable, "-c", ALONE], capture_output=True, text=True, check=True, cwd=ROOT
    )
    count, *failed = done.stdout.split("MODULES", 1)[1].split()
    assert int(count) > 100
    assert failed == []

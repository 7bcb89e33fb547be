"""The code that makes a stage, told apart by what it does, not by how it is worded.

A module counts by its syntax tree: comments, docstrings and layout do not. Which modules count is
found by following imports, without running them, from the classes that make a stage: inside their
packages, inside prime, and inside whatever is not installed but lies about as source.
"""

import ast
import hashlib
import importlib.util
import sys
import sysconfig
import warnings
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

Code = dict[str, str]
"""A digest for each module, by its dotted name."""

CORE = "prime_core"

WITHOUT_EFFECT = (
    "prime_core.configuration",
    "prime_core.errors",
    "prime_core.experiments.run_folder",
    "prime_core.experiments.stages.stage",
    "prime_core.files",
    "prime_core.hookspecs",
    "prime_core.registry",
)
"""Modules of the core, and folders of such, on which no result depends."""

_PACKAGES = {"site-packages", "dist-packages"}
"""Folders of installed packages; those of editable ones lie elsewhere."""

_NOT_OURS = sys.stdlib_module_names | {"pydantic"}


def code_of(classes: Iterable[type]) -> Code:
    """Return the code that classes run, what they inherit included.

    Args:
        classes: Of a stage and of the settings that it builds from.
    """
    modules = {item.__module__ for one in classes for item in one.__mro__}
    roots = {name for name in modules if _top(name) not in _NOT_OURS}
    packages = {_top(name) for name in roots} | {CORE}
    found: Code = {}
    waiting = sorted(roots)
    while waiting:
        name = waiting.pop()
        path = None if name in found or _is_without_effect(name) else _file_of(name)
        if path is None or not (_top(name) in packages or _is_source(_top(name))):
            continue
        found[name], imported = _read(name, path)
        waiting += imported
    return dict(sorted(found.items()))


def digest_of(code: Code) -> str:
    """Return a short name of code."""
    text = "\n".join(f"{name} {digest}" for name, digest in sorted(code.items()))
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def changes(before: Code, now: Code) -> list[str]:
    """Return the modules that differ, by name."""
    return sorted(name for name in before.keys() | now.keys() if before.get(name) != now.get(name))


def _top(name: str) -> str:
    return name.partition(".")[0]


def _is_without_effect(name: str) -> bool:
    return name == CORE or any(
        name == item or name.startswith(f"{item}.") for item in WITHOUT_EFFECT
    )


@cache
def _is_source(top: str) -> bool:
    """Whether a package is neither installed nor Python's own."""
    return any(not _is_installed(folder) for folder in _folders_of(top))


def _is_installed(folder: Path) -> bool:
    # By name, too: an environment may take in the packages of another one.
    if not _PACKAGES.isdisjoint(folder.parts):
        return True
    places = [sysconfig.get_path(name) for name in ("purelib", "platlib", "stdlib")]
    return any(folder.is_relative_to(Path(place).resolve()) for place in places)


@cache
def _folders_of(top: str) -> tuple[Path, ...]:
    """Return where the files of a top-level package lie, or of a module that is one file."""
    if top in sys.stdlib_module_names:
        return ()
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):  # a module that was made by hand
        return ()
    if spec is None:
        return ()
    places = spec.submodule_search_locations
    if places is None:
        return (Path(spec.origin).resolve().parent,) if spec.origin and spec.has_location else ()
    return tuple(Path(place).resolve() for place in places)


@cache
def _file_of(name: str) -> Path | None:
    """Return the source of a module, or None if there is no such module or no source."""
    known = getattr(sys.modules.get(name), "__file__", None)
    if known is not None:
        return Path(known) if known.endswith(".py") else None
    top, _, inner = name.partition(".")
    for folder in _folders_of(top):
        base = folder.joinpath(*inner.split(".")) if inner else folder
        for path in (base / "__init__.py", base.with_suffix(".py"), folder / f"{name}.py"):
            if path.is_file():
                return path
    return None


@cache
def _read(name: str, path: Path) -> tuple[str, tuple[str, ...]]:
    """Return the digest of a module, and the modules that it imports."""
    text = path.read_bytes()
    try:
        with warnings.catch_warnings(action="ignore"):  # it is not for us to judge
            tree = ast.parse(text)
    except (SyntaxError, ValueError):
        return hashlib.sha256(text).hexdigest()[:12], ()
    plain = "".join(_plain(tree))
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    return hashlib.sha256(plain.encode()).hexdigest()[:12], tuple(_imported(tree, package))


def _plain(node: ast.AST) -> Iterator[str]:
    """Yield a syntax tree as text, without what is empty: versions of Python differ in that."""
    yield f"({type(node).__name__}"
    for name, value in ast.iter_fields(node):
        parts = value if isinstance(value, list) else [value]
        for part in parts:
            if isinstance(part, ast.AST):
                if not _is_docstring(part):
                    yield f" {name}="
                    yield from _plain(part)
            elif part is not None:
                yield f" {name}={part!r}"
    yield ")"


def _is_docstring(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _imported(tree: ast.AST, package: str) -> Iterator[str]:
    """Yield the modules that are imported anywhere, but for type checkers.

    Args:
        tree: Of the module.
        package: That the module lies in: relative imports start there.
    """
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            source = _source_of(node, package)
            for alias in node.names:
                inner = f"{source}.{alias.name}"
                yield inner if _file_of(inner) else _home_of(source, alias.name)
        yield from _imported(node, package)


def _source_of(node: ast.ImportFrom, package: str) -> str:
    if not node.level:
        return node.module or ""
    parts = package.split(".")
    base = ".".join(parts[: len(parts) - node.level + 1])
    return f"{base}.{node.module}" if node.module else base


def _home_of(source: str, name: str) -> str:
    """Return where a name is defined that a package hands on, or the package."""
    found = getattr(sys.modules.get(source), name, None) if source == CORE else None
    return str(getattr(found, "__module__", source))

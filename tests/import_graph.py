"""What the files of a package import, read without importing them."""

import ast
import graphlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import prime_core


def module_of(path: Path, package: Path) -> str:
    """Return the dotted name of a file, from its package on."""
    parts = path.relative_to(package.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _is_for_types_only(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")


def nodes(
    tree: ast.AST, *, in_functions: bool = True, for_types: bool = False
) -> Iterator[ast.AST]:
    """Yield the nodes of a file.

    Args:
        tree: The file.
        in_functions: Whether those inside functions are among them.
        for_types: Whether those that only type checkers see are.
    """
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not in_functions:
            continue
        if _is_for_types_only(node) and not for_types:
            continue
        yield node
        yield from nodes(node, in_functions=in_functions, for_types=for_types)


def imported(path: Path, **which: bool) -> Iterator[tuple[str, str]]:
    """Yield module and name of all that a file imports; the name is empty for whole modules."""
    for node in nodes(ast.parse(path.read_text()), **which):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, f"{path}: imports name their module in full"
            yield from ((str(node.module), alias.name) for alias in node.names)


@cache
def graph_of(package: Path, *, in_functions: bool = True) -> dict[str, set[str]]:
    """Return which modules of a package import which, type checkers' imports left out."""
    files = {module_of(path, package): path for path in sorted(package.rglob("*.py"))}
    graph: dict[str, set[str]] = {module: set() for module in files}
    for module, path in files.items():
        for source, name in imported(path, in_functions=in_functions):
            target = f"{source}.{name}" if f"{source}.{name}" in files else source
            if target in files and target != module:
                graph[module].add(target)
    return graph


def circle_in(graph: dict[str, set[str]]) -> list[str]:
    """Return the modules of a circle of imports, or none."""
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        return list(error.args[1])
    return []


def not_public(path: Path, allowed: tuple[str, ...]) -> list[str]:
    """Return what a file imports of the core beside what is public."""
    return [
        f"{module}.{name}"
        for module, name in imported(path, for_types=True)
        if module.split(".")[0] == "prime_core"
        and not {module, f"{module}.{name}"} & {*allowed}
        and not module.startswith("prime_core.contracts.")
    ] + [
        f"prime_core.{name}"
        for module, name in imported(path, for_types=True)
        if module == "prime_core"
        and name not in prime_core.__all__
        and f"prime_core.{name}" not in allowed
    ]

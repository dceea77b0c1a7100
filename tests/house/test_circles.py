"""No file imports another that imports it in turn, inside functions neither. Names for annotations alone do not count,
but files that need each other for these are counted, so that they do not grow more."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

from helpers.sources import PACKAGES, files, nodes

ANNOTATED = 22  # files of the solver that name each other's records in annotations; may only fall


def _modules() -> dict[str, Path]:
    out = {}
    for package, folder in PACKAGES.items():
        for p in files(package):
            name = ".".join([package, *p.relative_to(folder).with_suffix("").parts])
            out[name.removesuffix(".__init__")] = p
    return out


MODULES = _modules()


@cache
def imports(name: str, path: Path, annotations: bool) -> frozenset[str]:
    """Modules of ours that a file imports, those inside functions too; ``annotations``: also under TYPE_CHECKING."""
    package = (name if path.name == "__init__.py" else name.rpartition(".")[0]).split(".")
    hidden: set[int] = set()
    for node in nodes(path):
        if isinstance(node, ast.If) and _for_types(node.test) and not annotations:
            hidden |= {id(inner) for inner in ast.walk(node)}
    out = set()
    for node in nodes(path):
        if id(node) in hidden:
            continue
        if isinstance(node, ast.Import):
            out |= {a.name for a in node.names}
        elif isinstance(node, ast.ImportFrom):
            stem = ".".join([*(package[: len(package) - node.level + 1] if node.level else []),
                             *(node.module.split(".") if node.module else [])])  # fmt: skip
            for a in node.names:
                out.add(f"{stem}.{a.name}" if f"{stem}.{a.name}" in MODULES else stem)
    return frozenset((out & set(MODULES)) - {name})


def _for_types(test: ast.expr) -> bool:
    return (test.id if isinstance(test, ast.Name) else getattr(test, "attr", "")) == "TYPE_CHECKING"


def circles(graph: dict[str, frozenset[str]]) -> list[list[str]]:
    """Sets of files that can be reached from each other (Tarjan, SIAM J Comput 1 (1972))."""
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(x: str) -> None:
        order[x] = low[x] = len(order)
        stack.append(x)
        for y in sorted(graph[x]):
            if y not in order:
                visit(y)
            if y in stack:
                low[x] = min(low[x], low[y])
        if low[x] == order[x]:
            part = stack[stack.index(x) :]
            del stack[stack.index(x) :]
            if len(part) > 1:
                found.append(sorted(part))

    for x in graph:
        if x not in order:
            visit(x)
    return found


def test_a_circle_is_found() -> None:
    graph = {"a": "b", "b": "c", "c": "ad", "d": "", "e": "a"}
    assert circles({x: frozenset(of) for x, of in graph.items()}) == [["a", "b", "c"]]
    assert "febkit.solver.newton" in imports("febkit.solver.run", MODULES["febkit.solver.run"], False)
    assert "febkit.lower.connectors" in imports("febkit.lower", MODULES["febkit.lower"], False)  # inside a function


def test_no_circles_of_imports() -> None:
    assert circles({name: imports(name, path, False) for name, path in MODULES.items()}) == []


def test_files_that_need_each_other_for_annotations_do_not_grow_more() -> None:
    graph = {name: imports(name, path, True) for name, path in MODULES.items()}
    inside = [n for part in circles(graph) for n in part if n.startswith("febkit.solver")]
    assert len(inside) <= ANNOTATED, inside

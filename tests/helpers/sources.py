"""The project's own source files, each parsed once in a process."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = {"febkit": ROOT / "febkit", "febkit.solver": ROOT / "solver", "febkit.templates": ROOT / "templates"}


@cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """All nodes of a file's syntax tree."""
    return tuple(ast.walk(ast.parse(path.read_text())))


@cache
def files(package: str) -> tuple[Path, ...]:
    """Python files of a package's folder; febkit's own links to solver and templates are not followed."""
    found = PACKAGES[package].rglob("*.py")
    if package == "febkit":
        return tuple(p for p in found if p.relative_to(ROOT / "febkit").parts[0] not in ("solver", "templates"))
    return tuple(found)

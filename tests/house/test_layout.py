"""The house keeps its shape: walls stand, names mean something."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from helpers.sources import PACKAGES, ROOT, files, nodes


def _imported(path: Path, package: str) -> set[str]:
    """Absolute names of the modules a file imports, those inside functions and under TYPE_CHECKING too."""
    inside = path.relative_to(PACKAGES[package]).parent.parts
    here = [*package.split("."), *inside]
    out = set()
    for node in nodes(path):
        if isinstance(node, ast.Import):
            out |= {a.name for a in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else []
            stem = ".".join([*base, *(node.module.split(".") if node.module else [])])
            out |= {stem, *(f"{stem}.{a.name}" for a in node.names)}
    return out


def _below(name: str, package: str) -> bool:
    return name == package or name.startswith(package + ".")


def test_the_solver_knows_nothing_of_the_rest() -> None:
    for path in files("febkit.solver"):
        outside = {n for n in _imported(path, "febkit.solver") if _below(n, "febkit") and n != "febkit"}
        assert {n for n in outside if not _below(n, "febkit.solver")} == set(), path


@pytest.mark.parametrize("package", ["febkit.solver", "febkit.templates"])
def test_what_ships_under_another_name_imports_itself_relatively(package: str) -> None:
    for path in files(package):
        for node in nodes(path):
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                assert not _below(node.module or "", package), f"{path}:{node.lineno}"


WALLS = [
    ("febkit/model", ("febkit.feb", "febkit.results", "febkit.solver", "febkit.lower", "febkit.cli", "febkit.output")),
    ("febkit/feb", ("febkit.results", "febkit.output", "febkit.cli", "febkit.coupling", "febkit.metrics")),
    ("febkit/results", ("febkit.solver", "febkit.lower", "febkit.cli", "febkit.output")),
    ("febkit/lower", ("febkit.results", "febkit.output", "febkit.cli", "febkit.feb")),
]


@pytest.mark.parametrize(("folder", "forbidden"), WALLS, ids=[w[0] for w in WALLS])
def test_imports_go_one_way(folder: str, forbidden: tuple[str, ...]) -> None:
    """Formats know the model, the model knows nothing, results know nothing of the solver."""
    for path in (ROOT / folder).rglob("*.py"):
        bad = {n for n in _imported(path, "febkit") for f in forbidden if _below(n, f)}
        assert bad == set(), path


def test_no_folder_or_file_is_called_utils() -> None:
    assert [p for f in PACKAGES for p in files(f) if "util" in str(p.relative_to(ROOT)).lower()] == []


def test_tests_share_what_helpers_holds() -> None:
    """Helpers are imported from tests/helpers (``pythonpath`` in pyproject.toml), not from folders put on the path."""
    for path in (p for p in (ROOT / "tests").rglob("*.py") if p.parent.name != "benchmarks"):
        calls = [n for n in nodes(path) if isinstance(n, ast.Call) and isinstance(n.func, ast.Attribute)]
        assert [n.lineno for n in calls if ast.unparse(n.func.value) == "sys.path"] == [], path


def test_links_for_static_readers() -> None:
    for name in ("solver", "templates"):
        assert (ROOT / "febkit" / name).resolve() == ROOT / name


# nodal arrays (node, column) indexed by a number, and tables of columns: only solver/fields.py may know one
_COLUMN = re.compile(
    r"(?:\.(?:d|d_old|kind|eq)|\b(?:R|total|active))\[[^\[\]]*,\s*:?\d+:?\s*\]"
    r"|\b(?:UX|UY|UZ|COLUMNS?|PRESSURE_COLUMN)\b"
)
_NODAL = [
    p for folder in ("solver", "febkit/lower", "febkit/output") for p in sorted((ROOT / folder).rglob("*.py"))
    if p.relative_to(ROOT / folder).parts[0] not in ("kernels", "solids", "elements")
]  # fmt: skip


def test_columns_of_nodal_arrays_have_names() -> None:
    assert len(_NODAL) > 100
    for path in _NODAL:
        lines = enumerate(path.read_text().splitlines(), 1)
        assert [f"{k}: {line.strip()}" for k, line in lines if _COLUMN.search(line)] == [], path


def test_what_names_a_column_is_found() -> None:
    for line in ("s.d[:, 3]", "s.d[:, :3]", "R[self.row, :3] += f", "eqs.kind[n, 3]", "from x import UX, P"):
        assert _COLUMN.search(line)
    assert not _COLUMN.search("s.d[:, column]") and not _COLUMN.search("q.d[:3]")


def test_what_the_solver_calls_has_a_protocol() -> None:
    """Loads, contacts and laws say what they do by methods with defaults, not by what they lack."""
    for path in files("febkit.solver"):
        calls = [n for n in nodes(path) if isinstance(n, ast.Call)]
        assert [n.lineno for n in calls if isinstance(n.func, ast.Name) and n.func.id == "hasattr"] == [], path


def _reads_text(call: ast.Call) -> bool:
    """True for ``float(leaf.text)``, ``int(c.str("tag"))``, ``float(c.attrs["lc"])`` and the like."""
    inside = [n for a in call.args for n in ast.walk(a)]
    return any(isinstance(n, ast.Attribute) and n.attr in ("text", "str", "attrs") for n in inside)


def test_lowering_reads_values_in_one_way() -> None:
    """Text becomes a number in febkit.model.values only, which names the tag and the line where it is none."""
    for path in (ROOT / "febkit" / "lower").glob("*.py"):
        for node in nodes(path):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("float", "int"):
                assert not _reads_text(node), f"{path}:{node.lineno}"

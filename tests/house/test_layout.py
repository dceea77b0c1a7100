"""The house keeps its shape: walls stand, names mean something."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = {"febkit": ROOT / "febkit", "febkit.solver": ROOT / "solver", "febkit.templates": ROOT / "templates"}


def _files(package: str) -> list[Path]:
    """Python files of a package folder; febkit's own links to solver and templates are not followed."""
    found = SOURCES[package].rglob("*.py")
    if package == "febkit":
        return [p for p in found if not any((ROOT / "febkit" / q) in p.parents for q in ("solver", "templates"))]
    return list(found)


def _imported(path: Path, package: str) -> set[str]:
    """Absolute names of the modules a file imports, those inside functions and under TYPE_CHECKING too."""
    inside = path.relative_to(SOURCES[package]).parent.parts
    here = [*package.split("."), *inside]
    out = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            out |= {a.name for a in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else []
            stem = ".".join([*base, *(node.module.split(".") if node.module else [])])
            out |= {stem, *(f"{stem}.{a.name}" for a in node.names)}
    return out


def _below(name: str, package: str) -> bool:
    return name == package or name.startswith(package + ".")


@pytest.mark.parametrize("path", _files("febkit.solver"), ids=lambda p: str(p.relative_to(ROOT)))
def test_the_solver_knows_nothing_of_the_rest(path: Path) -> None:
    outside = {n for n in _imported(path, "febkit.solver") if _below(n, "febkit") and n != "febkit"}
    assert {n for n in outside if not _below(n, "febkit.solver")} == set()


@pytest.mark.parametrize("package", ["febkit.solver", "febkit.templates"])
def test_what_ships_under_another_name_imports_itself_relatively(package: str) -> None:
    for path in _files(package):
        for node in ast.walk(ast.parse(path.read_text())):
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
    assert [p for f in SOURCES for p in _files(f) if "util" in str(p.relative_to(ROOT)).lower()] == []


def test_tests_share_what_helpers_holds() -> None:
    """Helpers are imported from tests/helpers (``pythonpath`` in pyproject.toml), not from folders put on the path."""
    for path in (p for p in (ROOT / "tests").rglob("*.py") if p.parent.name != "benchmarks"):
        calls = [n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Call)]
        assert [n.lineno for n in calls if ast.unparse(n.func).startswith("sys.path.")] == [], path


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


@pytest.mark.parametrize("path", _NODAL, ids=lambda p: str(p.relative_to(ROOT)))
def test_columns_of_nodal_arrays_have_names(path: Path) -> None:
    found = [f"{k}: {line.strip()}" for k, line in enumerate(path.read_text().splitlines(), 1) if _COLUMN.search(line)]
    assert not found


def test_what_names_a_column_is_found() -> None:
    for line in ("s.d[:, 3]", "s.d[:, :3]", "R[self.row, :3] += f", "eqs.kind[n, 3]", "from x import UX, P"):
        assert _COLUMN.search(line)
    assert not _COLUMN.search("s.d[:, column]") and not _COLUMN.search("q.d[:3]")


@pytest.mark.parametrize("path", _files("febkit.solver"), ids=lambda p: str(p.relative_to(ROOT)))
def test_what_the_solver_calls_has_a_protocol(path: Path) -> None:
    """Loads, contacts and laws say what they do by methods with defaults, not by what they lack."""
    calls = [n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Call)]
    assert not [n.lineno for n in calls if isinstance(n.func, ast.Name) and n.func.id == "hasattr"]


def _reads_text(call: ast.Call) -> bool:
    """True for ``float(leaf.text)``, ``int(c.str("tag"))``, ``float(c.attrs["lc"])`` and the like."""
    inside = [n for a in call.args for n in ast.walk(a)]
    return any(isinstance(n, ast.Attribute) and n.attr in ("text", "str", "attrs") for n in inside)


@pytest.mark.parametrize("path", sorted((ROOT / "febkit" / "lower").glob("*.py")), ids=lambda p: p.name)
def test_lowering_reads_values_in_one_way(path: Path) -> None:
    """Text becomes a number in febkit.model.values only, which names the tag and the line where it is none."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("float", "int"):
            assert not _reads_text(node), f"{path}:{node.lineno}"

"""The notebooks of examples/ run from top to bottom in a real kernel, and keep small outputs that say the same."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

nbclient = pytest.importorskip("nbclient", reason="notebooks are run by nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel", reason="notebooks need a kernel")

EXAMPLES = Path(__file__).parents[2] / "examples"
NOTEBOOKS = sorted((EXAMPLES / "notebooks").glob("*.ipynb"))
MOST = 120  # s
LARGEST = 450_000  # bytes
LESS = {  # what a notebook does more often than it takes to see that it runs
    "03_sweep": ("np.geomspace(4e-3, 0.1, 7)", "np.geomspace(4e-3, 0.1, 3)"),
    "05_study": ("methods=[\"1\", \"2\"]", "methods=[\"1\"]"),
}


def kinds(cell: Any) -> list[str]:
    """What a cell shows: "text/plain" and "image/png" of results, "stdout", "stderr" (which may come in pieces)."""
    out: list[str] = []
    for o in cell.get("outputs", []):
        kind = o.get("name") or ("image/png" if "image/png" in o["data"] else "text/plain")
        if kind not in ("stdout", "stderr") or kind not in out[-1:]:
            out.append(kind)
    return out


def test_there_are_six_that_start_at_one() -> None:
    assert [p.name[:2] for p in NOTEBOOKS] == ["01", "02", "03", "04", "05", "06"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_outputs_are_kept_and_small(path: Path) -> None:
    book = nbformat.read(path, 4)
    nbformat.validate(book)
    shown = [k for c in book.cells for k in kinds(c)]
    assert path.stat().st_size < LARGEST and "stderr" not in shown
    assert "image/png" in shown and ("text/plain" in shown or "stdout" in shown)


@pytest.fixture(scope="module")
def kernel() -> Iterator[Any]:
    """One for all notebooks, as most of its time goes into imports; each begins with no names."""
    from jupyter_client.manager import KernelManager

    km = KernelManager(kernel_name="python3")
    km.start_kernel()
    yield km
    km.shutdown_kernel(now=True)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebook(path: Path, tmp_path: Path, kernel: Any) -> None:
    kept, book = nbformat.read(path, 4), nbformat.read(path, 4)
    (tmp_path / "notebooks").mkdir()
    for model in ("study_reduced.toml", "unconfined_compression.feb"):
        shutil.copy(EXAMPLES / model, tmp_path)
    begin = nbformat.v4.new_code_cell(f"%reset -f\nimport os\nos.chdir({str(tmp_path / 'notebooks')!r})\ndel os")
    for cell in book.cells:
        cell.source = cell.source.replace(*LESS.get(path.stem, ("", "")))
    assert (book.cells != kept.cells) == (path.stem in LESS)
    book.cells.insert(0, begin)
    nbclient.NotebookClient(book, timeout=MOST, km=kernel).execute()
    assert [kinds(c) for c in book.cells] == [[], *(kinds(c) for c in kept.cells)]

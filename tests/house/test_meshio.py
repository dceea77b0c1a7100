"""meshio knows .feb and .xplt where febkit is imported, before it or after."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("meshio")
ROOT = Path(__file__).parents[2]
MODEL = ROOT / "examples" / "unconfined_compression.feb"


def _said(program: str, *options: str, cwd: Path | None = None) -> str:
    command = [sys.executable, *options, "-c", program]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("start", [
    "import febkit, meshio", "import meshio, febkit", "import meshio, febkit.meshio_format",
    # asked for and not loaded, first
    "import febkit, importlib.util\nimportlib.util.find_spec('meshio')\nimport meshio",
], ids=["febkit first", "meshio first", "by hand", "found before"])  # fmt: skip
def test_meshio_reads_and_writes_feb(start: str, tmp_path: Path) -> None:
    program = f"""{start}
m = meshio.read({str(MODEL)!r})
m.write({str(tmp_path / "again.feb")!r})
again = meshio.read({str(tmp_path / "again.feb")!r})
assert (again.points == m.points).all() and ".xplt" in meshio.extension_to_filetypes
print(len(m.points), *[c.type for c in again.cells])"""
    assert _said(program).split()[1:] == ["hexahedron"]


def test_importing_febkit_does_not_import_meshio() -> None:
    assert _said("import febkit, sys; print('meshio' in sys.modules)") == "False"


def test_a_meshio_that_has_changed_is_imported_all_the_same(tmp_path: Path) -> None:
    """Registering fails with a warning: meshio must not fail for febkit's sake."""
    (tmp_path / "meshio.py").write_text("here = True")
    program = f"""import sys, warnings
sys.path.insert(0, {str(tmp_path)!r})
import febkit
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    import meshio
print(meshio.here, "could not register" in str(said[0].message))"""
    assert _said(program) == "True True"

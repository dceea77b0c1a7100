"""meshio knows .feb and .xplt: where febkit is imported, and where its .pth file is read."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("meshio")
ROOT = Path(__file__).parents[2]
MODEL = ROOT / "examples" / "unconfined_compression.feb"
PTH = (ROOT / "febkit_meshio.pth").read_text()


def _said(program: str, *options: str, cwd: Path | None = None) -> str:
    command = [sys.executable, *options, "-c", program]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("start", [
    "import febkit, meshio", "import meshio, febkit", "import meshio, febkit.meshio_format",
    f"{PTH}\nimport meshio",
    # asked for and not loaded, first
    f"{PTH}\nimport importlib.util\nimportlib.util.find_spec('meshio')\nimport meshio",
], ids=["febkit first", "meshio first", "by hand", ".pth", "found before"])  # fmt: skip
def test_meshio_reads_and_writes_feb(start: str, tmp_path: Path) -> None:
    program = f"""{start}
m = meshio.read({str(MODEL)!r})
m.write({str(tmp_path / "again.feb")!r})
again = meshio.read({str(tmp_path / "again.feb")!r})
assert (again.points == m.points).all() and ".xplt" in meshio.extension_to_filetypes
print(len(m.points), *[c.type for c in again.cells])"""
    assert _said(program).split()[1:] == ["hexahedron"]


@pytest.mark.parametrize("left", [(), ("__init__.py",), ("__init__.py", "_version.py")], ids=str)
def test_half_a_febkit_does_not_harm_meshio(tmp_path: Path, left: tuple[str, ...]) -> None:
    """As after an uninstall that was interrupted: the .pth file is there, the package is not or not whole."""
    (tmp_path / "febkit").mkdir()
    for name in left:
        (tmp_path / "febkit" / name).write_bytes((ROOT / "febkit" / name).read_bytes())
    program = f"""import sys
sys.path.insert(0, {str(tmp_path)!r})
{PTH}
import meshio
print(".feb" in meshio.extension_to_filetypes)"""
    # -S leaves out site and with it an installed febkit
    paths = "\n".join(f"sys.path.append({p!r})" for p in sys.path if p and Path(p) != ROOT)
    assert _said(program.replace("import sys", f"import sys\n{paths}", 1), "-S", "-W", "error", cwd=tmp_path) == "False"


def test_starting_python_loads_nothing() -> None:
    before = _said("import sys; print(len(sys.modules))")
    assert _said(f"{PTH}\nprint(len(sys.modules))") == before
    assert PTH.count("\n") == 1 and PTH.startswith("import ")  # or site does not run it

"""The wheel holds everything: built and unpacked away from the sources, it makes and solves a model."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SHIPPED = ("febkit", "solver", "templates", "pyproject.toml", "setup.py", "README.md", "LICENSE")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what the wheel installs, and nothing of the sources."""
    if importlib.util.find_spec("setuptools") is None:
        pytest.skip("setuptools is not installed here: the wheel cannot be built without a network")
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("site")
    for name in SHIPPED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, source / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, source / name)
    pip = [sys.executable, "-m", "pip", "-q", "install", "--no-deps", "--no-index", "--no-build-isolation"]
    args = [*pip, "--target", str(out), str(source)]
    env = {**os.environ, "FEBKIT_LEVELS": "none"}  # .ci/run builds the kernels
    done = subprocess.run(args, capture_output=True, text=True, check=False, env=env)
    if "Cannot import 'setuptools.build_meta'" in done.stderr or "No module named pip" in done.stderr:
        pytest.skip("no pip with setuptools here to build the wheel with")
    assert done.returncode == 0, done.stderr
    if (made := ROOT / "solver" / "machine").is_dir():  # of the same sources
        shutil.copytree(made, out / "febkit" / "solver" / "machine", dirs_exist_ok=True)
    return out


def _febkit(site: Path, folder: Path, *args: str) -> str:
    env = {**os.environ, "PYTHONPATH": str(site)}
    program = "import febkit, sys; assert febkit.__file__.startswith(sys.argv.pop(1)); "
    program += "from febkit.cli.main import main; main()"
    done = subprocess.run([sys.executable, "-c", program, str(site), *args], cwd=folder, env=env, capture_output=True,
                          text=True, check=False)  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_nothing_else_lands_in_site_packages(site: Path) -> None:
    names = {p.name for p in site.iterdir() if not p.name.endswith(".dist-info")} - {"bin", "Scripts", "__pycache__"}
    assert names == {"febkit"}


def test_every_module_and_data_file_is_in_it(site: Path) -> None:
    """A forgotten subpackage works in an editable install and would be missing here."""
    shipped = {
        "febkit": ROOT / "febkit", "febkit/solver": ROOT / "solver", "febkit/templates": ROOT / "templates",
    }  # fmt: skip
    for place, folder in shipped.items():
        kinds = (".py", ".npz", ".toml", ".feb", ".typed")
        ours = [p.relative_to(folder) for p in _followed(folder) if p.suffix in kinds]
        assert len(ours) > 5
        assert [str(p) for p in ours if (site / place / p).read_bytes() != (folder / p).read_bytes()] == []


def _followed(folder: Path) -> list[Path]:
    """Files below a folder; its links to other folders are not followed."""
    own = [p for p in folder.iterdir() if not p.is_symlink()]
    return [q for p in own for q in (p.rglob("*") if p.is_dir() else [p]) if q.is_file()]


READ = """
import sys, site
site.addsitedir({site!r})
assert not [m for m in sys.modules if m.split(".")[0] == "febkit"], "starting Python must not load febkit"
import febkit, meshio
assert ("febkit.feb" in sys.modules) is False, "nor must meshio load its readers"
print(len(meshio.read({model!r}).points))
"""


def test_meshio_reads_feb_files(site: Path, tmp_path: Path) -> None:
    pytest.importorskip("meshio")
    (tmp_path / "m.feb").write_bytes((ROOT / "examples" / "unconfined_compression.feb").read_bytes())
    program = READ.format(site=str(site), model=str(tmp_path / "m.feb"))
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 100


def test_makes_and_solves_a_model(site: Path, tmp_path: Path) -> None:
    _febkit(site, tmp_path, "new", "tissue", "--set", "n=3", "--set", "times=0,1,2", "-o", "t.feb")
    assert "solved" in _febkit(site, tmp_path, "run", "t.feb")
    assert (tmp_path / "t.xplt").stat().st_size > 0

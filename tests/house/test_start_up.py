"""What starting costs: numba and other heavy packages are imported when something is solved, not before."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("numba", "llvmlite", "scipy.sparse", "matplotlib", "dask", "meshio")
MODEL = Path(__file__).parents[2] / "examples" / "unconfined_compression.feb"

PROGRAM = """
import sys
from febkit.cli.main import cli
try:
    cli.main({args!r}, standalone_mode=True)
except SystemExit as e:
    assert e.code in (0, None), e.code
print("HEAVY:", *[m for m in {heavy!r} if m in sys.modules])
"""


def _loaded(args: list[str], heavy: tuple[str, ...]) -> set[str]:
    program = PROGRAM.format(args=args, heavy=heavy)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.rsplit("HEAVY:", 1)[1].split())


@pytest.mark.parametrize("args", [["--help"], ["run", "--help"], ["--version"]], ids=" ".join)
def test_help_imports_nothing_heavy(args: list[str]) -> None:
    assert _loaded(args, (*HEAVY, "numpy", "xarray", "lxml")) == set()


@pytest.mark.parametrize("verb", ["validate", "info"])
def test_looking_at_a_model_does_not_import_numba(verb: str) -> None:
    assert _loaded([verb, str(MODEL)], ("numba", "llvmlite", "matplotlib", "dask")) == set()


def test_converting_does_not_import_numba(tmp_path: Path) -> None:
    out = tmp_path / "m.feb"
    assert _loaded(["convert", str(MODEL), str(out)], ("numba", "llvmlite", "matplotlib", "dask")) == set()
    assert out.stat().st_size > 0


def test_a_new_model_does_not_import_numba(tmp_path: Path) -> None:
    out = tmp_path / "t.feb"
    args = ["new", "tissue", "--set", "n=3", "-o", str(out)]
    assert _loaded(args, ("numba", "llvmlite", "matplotlib", "dask")) == set()


def test_saying_what_can_be_solved_does_not_import_numba() -> None:
    """All the solver's tables and laws come without numba: kernels are compiled when they are called."""
    program = (
        "import sys, pkgutil, importlib, febkit.lower\n"
        "names = []\n"
        "for n in ('elements', 'kernels', 'loads', 'permeabilities', 'solids', 'supplies'):\n"
        "    package = importlib.import_module('febkit.solver.' + n)\n"
        "    names += [m.name for m in pkgutil.walk_packages(package.__path__, package.__name__ + '.')]\n"
        "for n in names: importlib.import_module(n)\n"
        "from febkit.feb import validate\n"
        f"found = validate({str(MODEL)!r}, solvable=True)\n"
        "assert not [f for f in found if f.severity in ('error', 'unsupported')], found\n"
        "print(len(names) > 100, 'numba' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["True", "False"], done.stderr


def test_reading_does_not_import_numba() -> None:
    program = f"import sys, febkit; febkit.read({str(MODEL)!r}); print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_importing_febkit_imports_nothing_else() -> None:
    """`import febkit` costs less than numpy's import: it loads no package but itself."""
    program = (
        "import sys; before = set(sys.modules); import febkit\n"
        "print(*sorted({m.partition('.')[0] for m in set(sys.modules) - before} - set(sys.stdlib_module_names)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["febkit"]


def test_building_editing_and_writing_import_no_numba(tmp_path: Path) -> None:
    program = (
        "import sys, febkit\n"
        "from febkit import materials as mt\n"
        "m = febkit.Model('biphasic')\n"
        "m.add_block('b', (1, 1, 1), (2, 2, 2))\n"
        "solid, k = mt.NeoHookean(E=1, v=0.1), mt.PermConstIso(perm=1)\n"
        "m.materials['c'] = mt.Biphasic(solid=solid, permeability=k, phi0=0.2)\n"
        "m.fix(m.nodes(z='min'), 'z'); m.load(m.faces(z='max'), 'pressure', pressure=1, curve=[(0, 0), (1, 1)])\n"
        "m.materials['c'].solid.E = 2; m.step(time=1, dt=0.1); m.copy(); repr(m)\n"
        f"m.write({str(tmp_path / 'm.feb')!r}); m.validate(); assert febkit.read({str(tmp_path / 'm.feb')!r}) == m\n"
        "print([n for n in ('numba', 'llvmlite', 'matplotlib', 'dask', 'pyvista') if n in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "[]", done.stderr


def test_the_command_itself_imports_nothing_heavy() -> None:
    """As a shell calls it: what handles errors must not cost what it never meets (0.3 s is the aim; see benchmarks)."""
    program = (
        "import sys; sys.argv = ['febkit', '--help']\n"
        "from febkit.cli.main import main\n"
        "try:\n    main()\nfinally:\n"
        "    print('HEAVY:', *[m for m in ('numpy', 'numba', 'lxml', 'xarray', 'rich') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.rsplit("HEAVY:", 1)[1].split() == []

"""Models built by the API are FEBio's models: what they write FEBio 4.11 runs to the same end.

``PYTHONPATH=tests python tests/modelling/test_built.py FEBIO`` prints :data:`REFERENCE`
anew, by running FEBio's program on the files.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import febkit
from helpers.built import MODELS

# of FEBio 4.11, by model: last time; mean displacement of the set "top", and the reaction on it along z where that is
# prescribed; root mean square of the displacements of all nodes, and of the effective fluid pressures if there are any
REFERENCE: dict[str, tuple[float, ...]] = {
    "stretched_rubber": (1, -0.091264255, -0.091264255, 0.5, -2.3866088, 0.36322245),
    "fibers_under_pressure": (1, -0.090338686, 0.017044244, 0.034088489, 0, 0.1168904),
    "drained_plug": (100, 0.015268409, 0.015268409, -0.1, 0.060554113, 0.0679769, 0.0224629),
    "squeezed_column": (50, 0, 0, -0.071816325, 0, 0.042099854, 0.054337826),
    "turned_grip": (1, 0, 0, 0.30000001, 0, 0.32781819),
    "pushed_plate": (1, 0.16810628, 0, -0.059904436, 0, 0.14878216),
    "block_on_block": (1, 0, 0, -0.15000001, 0.31642948, 0.08960498),
    "glued_blocks": (1, 0.2, 0, -0.1, 0.071255099, 0.14205276),
    "bent_plate": (1, 0.0004706983, 0, -0.070646927, 0, 0.037834399),
    "three_steps": (6, -0.035703467, 0.2, 0.30000001, -0.30712116, 0.23208921),
}
PRESCRIBED = {"stretched_rubber", "drained_plug", "block_on_block", "glued_blocks", "three_steps"}


def measured(name: str, ds: xr.Dataset) -> tuple[float, ...]:
    """The numbers of REFERENCE, of a dataset's last state."""
    last = ds.isel(time=-1)
    u = np.asarray(last["displacement"].values, dtype=float)
    top = np.asarray(ds.febkit.node_set("top").isel(time=-1)["displacement"].values, dtype=float).mean(axis=0)
    force = -float(ds.febkit.reaction("top").sel(xyz="z")[-1]) if name in PRESCRIBED else 0.0
    out = [float(ds["time"].values[-1]), *top, force, float(np.sqrt((u**2).sum(axis=1).mean()))]
    if "effective_fluid_pressure" in ds:
        out.append(float(np.sqrt(np.nanmean(np.asarray(last["effective_fluid_pressure"].values, dtype=float) ** 2))))
    return tuple(out)


def febio(program: str, m: febkit.Model, folder: Path) -> xr.Dataset:
    """What FEBio's program makes of the file that the model writes."""
    m.write(folder / "m.feb")
    command = [program, "-i", "m.feb", "-o", "m.log", "-p", "m.xplt", "-silent"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    assert "N O R M A L   T E R M I N A T I O N" in (folder / "m.log").read_text()
    return febkit.open_results(folder / "m.xplt").load()


def test_there_are_ten_and_all_have_references() -> None:
    assert len(MODELS) == 10 and MODELS.keys() == REFERENCE.keys()


@pytest.mark.parametrize("name", MODELS)
def test_febkit_gives_what_febio_gave(name: str) -> None:
    m = MODELS[name]()
    assert m.validate() == []
    result = m.solve()
    assert result.converged, result.reason
    found = measured(name, result.dataset)
    assert found == pytest.approx(REFERENCE[name], rel=2e-6, abs=2e-7 * max(map(abs, found[1:])))


@pytest.mark.parametrize("name, sign", [("stretched_rubber", -1), ("drained_plug", 1)])
def test_logged_reactions_have_febio_s_sign(name: str, sign: int, tmp_path: Path) -> None:
    """FEBio 4.11 logs the forces on a solid, and those that a mixture puts on what holds it, as its plotfiles do."""
    m = MODELS[name]()
    m.output.log("node_data", "Rz", "top", file="forces.txt")
    febkit.solve(m, tmp_path / "m.xplt", tmp_path / "m.log")
    rows = [r for r in (tmp_path / "forces.txt").read_text().splitlines() if r and not r.startswith("*")]
    last = rows[-len(m.node_sets["top"]) :]
    total = sum(float(r.replace(",", " ").split()[1]) for r in last)
    assert total == pytest.approx(sign * REFERENCE[name][4], rel=1e-5)


@pytest.mark.parametrize("name", MODELS)
def test_the_file_says_the_same(name: str, tmp_path: Path) -> None:
    m = MODELS[name]()
    assert m.write(tmp_path / "m.feb") == []
    assert febkit.read(tmp_path / "m.feb") == m


@pytest.mark.skipif("FEBIO" not in os.environ, reason="FEBIO names FEBio's program")
@pytest.mark.parametrize("name", MODELS)
def test_febio_runs_the_file_to_the_reference(name: str, tmp_path: Path) -> None:
    found = measured(name, febio(os.environ["FEBIO"], MODELS[name](), tmp_path))
    assert found == pytest.approx(REFERENCE[name], rel=1e-6)


if __name__ == "__main__":
    from tempfile import TemporaryDirectory

    print("REFERENCE: dict[str, tuple[float, ...]] = {")
    for name, build in MODELS.items():
        with TemporaryDirectory() as folder:
            said = ", ".join(f"{x:.8g}" for x in measured(name, febio(sys.argv[1], build(), Path(folder))))
            print(f'    "{name}": ({said}),')
    print("}")

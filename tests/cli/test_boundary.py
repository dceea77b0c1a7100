"""``febkit boundary`` from the command line: what it writes, says and refuses."""

import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from febkit.cli.boundary import command
from febkit.feb import read, write
from febkit.model import Component, Domain, ElementBlock, InputError, Mesh, Model, Step


def cube(n, edge):
    """Nodes and bricks of a cube of n elements along an edge, centred at the origin."""
    g = np.linspace(-edge / 2, edge / 2, n + 1)
    z, y, x = np.meshgrid(g, g, g, indexing="ij")
    k, j, i = (a.ravel() for a in np.meshgrid(*(np.arange(n),) * 3, indexing="ij"))
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    m = n + 1
    conn = np.stack([((k + c) * m + j + b) * m + i + a for c in (0, 1) for a, b in ring], axis=1)
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1), conn


@pytest.fixture
def folder(tmp_path):
    """tissue.nc, a result with a quadratic field; cell.feb, a cube of 0.1; experiment.csv."""
    import xarray as xr

    X, conn = cube(6, 1.0)
    t = np.linspace(0, 1, 12) ** 2
    u = np.stack([0.1 * X[:, 0] * X[:, 2], 0.05 * X[:, 1], -0.1 * X[:, 2] ** 2], axis=1)
    xr.Dataset(
        {"displacement": (("time", "node", "xyz"), t[:, None, None] * u),
         "effective_fluid_pressure": (("time", "node"), t[:, None] * (1 + X[:, 2])),
         "X": (("node", "xyz"), X), "connectivity": (("element", "local"), conn)},
        {"time": t, "node_id": ("node", np.arange(len(X)) + 1), "element_id": ("element", np.arange(len(conn)) + 1),
         "part": ("element", np.zeros(len(conn), int)), "element_type": ("element", np.zeros(len(conn), int))},
        {"element_types": ["hex8"], "parts": ["tissue"]},
    ).to_netcdf(tmp_path / "tissue.nc")
    Y, bricks = cube(2, 0.1)
    control = Component("Control", children=tuple(Component(k, text=v) for k, v in (
        ("analysis", "TRANSIENT"), ("time_steps", "10"), ("step_size", "0.1"))))
    stepper = Component("time_stepper", "default", children=(Component("dtmax", text="0.1"),))
    control = Component("Control", children=(*control.children, stepper))
    solid = Component("solid", "neo-Hookean", children=(Component("E", text="1"), Component("v", text="0")))
    flow = Component("permeability", "perm-const-iso", children=(Component("perm", text="0.002"),))
    material = Component("material", "biphasic", "ecm", 1, children=(Component("phi0", text="0.2"), solid, flow))
    mesh = Mesh(np.arange(len(Y)) + 1, Y, (ElementBlock("ecm", "hex8", np.arange(len(bricks)) + 1, bricks),))
    write(Model("4.0", "biphasic", mesh, (material,), (Domain("ecm", "solid", "ecm"),),
                steps=(Step(control=control),)), tmp_path / "cell.feb")
    (tmp_path / "experiment.csv").write_text("time,Fzz,p\n0,1,0\n1,0.9,0.2\n")
    return tmp_path


def run(folder, *args):
    names = [str(folder / a) if a.endswith((".nc", ".feb", ".csv")) else a for a in args]
    result = CliRunner().invoke(command, names)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code == 0, result.output
    return result.output


def test_a_tissue_drives_a_cell_model(folder):
    said = run(folder, "tissue.nc", "cell.feb", "--at", "0.1,0,-0.2", "--order", "2", "--fluid-order", "1",
               "-o", "d.feb")
    assert "detF at the point" in said and "det dx/dX over the surface" in said
    assert "cell model / tissue element: 0.6" in said and "order left out" in said
    assert "must points at 12 times" in said
    back = read(folder / "d.feb")
    assert len(back.common.boundary) == 4
    assert len(back.mesh.node_sets["driven"].nodes) == 26
    assert back.steps[0].control.need("time_stepper").need("dtmax").lc is not None


def test_a_driven_model_is_validated_without_a_warning(folder):
    from febkit.feb import validate

    run(folder, "tissue.nc", "cell.feb", "--at", "0,0,0", "-o", "d.feb")
    assert "drive_" in (folder / "d.feb").read_text()
    assert not [str(f) for f in validate(folder / "d.feb", solvable=True) if f.severity != "hint"]


def test_several_points_make_several_files_and_a_dataset(folder):
    import xarray as xr

    (folder / "p.csv").write_text("name,x,y,z\nleft,-0.2,0,0\nright,0.2,0,0.1\n")
    run(folder, "tissue.nc", "cell.feb", "--points", "p.csv", "--dataset", "s.nc", "-o", "d.feb")
    assert (folder / "d_left.feb").is_file() and (folder / "d_right.feb").is_file()
    with xr.open_dataset(folder / "s.nc") as ds:
        assert ds["point"].values.tolist() == ["left", "right"]
        # F_zz = 1 - 0.2 z, G_zzz = -0.2 at the end
        assert ds["F"].values[:, -1, 2, 2] == pytest.approx([1.0, 0.98], abs=1e-12)
        assert ds["G"].values[:, -1, 2, 2, 2] == pytest.approx(-0.2, abs=1e-10)
        assert ds.attrs["source"].endswith("tissue.nc") and ds.attrs["recovery"] == "patches"
    run(folder, "s.nc", "cell.feb", "-o", "again.feb")
    assert (folder / "again_left.feb").read_bytes() == (folder / "d_left.feb").read_bytes()


def test_the_order_with_the_least_error_is_taken_and_kept(folder):
    import xarray as xr

    said = run(folder, "tissue.nc", "cell.feb", "--at", "0.1,0,-0.2", "--order", "auto", "--dataset", "s.nc",
               "-o", "d.feb")
    assert "estimated error" in said and "by the tissue's mesh" in said
    with xr.open_dataset(folder / "s.nc") as ds:
        solid, fluid = int(ds["solid_order"][0]), int(ds["fluid_order"][0])
        assert f"order {solid} for the solid, {fluid} for the fluid" in said
        least = (ds["strain_error"] ** 2).mean("time").isel(point=0)
        assert int(least["handed_order"][int(least.values.argmin())]) == solid
        assert ds["u_error"].attrs["long_name"] and "formula" in ds["u_error"].attrs
    again = run(folder, "s.nc", "cell.feb", "-o", "again.feb")  # goes by the orders that the data name
    assert f"order {solid} for the solid" in again
    assert (folder / "again.feb").read_bytes() == (folder / "d.feb").read_bytes()


def test_orders_that_were_asked_for_are_named_in_the_dataset(folder):
    import xarray as xr

    run(folder, "tissue.nc", "cell.feb", "--at", "0,0,0", "--order", "1", "--fluid-order", "2", "--dataset", "s.nc",
        "-o", "d.feb")
    with xr.open_dataset(folder / "s.nc") as ds:
        assert (int(ds["solid_order"][0]), int(ds["fluid_order"][0])) == (1, 2)


def test_an_experiment_drives_a_cell_model_with_the_orders_it_has(folder):
    said = run(folder, "experiment.csv", "cell.feb", "-o", "e.feb")
    assert "order 1 for the solid, 0 for the fluid" in said and "4.0, math" in said


@pytest.mark.parametrize("extra", [["--overlay"], ["--section"], ["--form", "curves"], ["--recovery", "element"],
                                   ["--rigid", "keep"], ["--no-pressure"], ["--no-must-points"],
                                   ["--origin", "centre"], ["--times", "0,0.5,1"], ["--order", "3"]])
def test_options_write_a_file(folder, extra):
    said = run(folder, "tissue.nc", "cell.feb", "--at", "0,0,0", *extra, "-o", "d.feb")
    assert "wrote" in said and (folder / "d.feb").stat().st_size > 500
    if extra == ["--recovery", "element"]:
        assert "pure second" in said
    if extra == ["--no-pressure"]:
        assert "fluid pressure" not in (folder / "d.feb").read_text()


@pytest.mark.parametrize(("args", "message"), [
    (["tissue.nc", "cell.feb"], "which point"),
    (["tissue.nc", "--at", "0,0,0", "--order", "auto", "--dataset", "s.nc"], "give the cell model"),
    (["experiment.csv", "cell.feb", "--order", "auto"], "no orders were chosen"),
    (["tissue.nc", "--at", "0,0,0"], "nothing to write"),
    (["tissue.nc", "cell.feb", "--at", "0,0"], "3 finite numbers"),
    (["tissue.nc", "cell.feb", "--at", "0,0,nan"], "3 finite numbers"),
    (["tissue.nc", "cell.feb", "--at", "0,0,x"], "numbers with commas"),
    (["tissue.nc", "cell.feb", "--at", "0,0,0.6"], r"outside the tissue.*\(0, 0, 0\.6\)"),
    (["tissue.nc", "cell.feb", "--at", "0,0,0.49", "--overlay"], "nodes outside the tissue"),
    (["tissue.nc", "cell.feb", "--at", "0,0,0", "--origin", "9,9,9"], "far outside the cell model"),
    (["tissue.nc", "cell.feb", "--at", "0,0,0", "--set", "none"], 'no node set "none"'),
    (["tissue.nc", "cell.feb", "--at", "0,0,0", "--times", "0,5"], "the result covers 0 to 1"),
    (["experiment.csv", "cell.feb", "--at", "0,0,0"], "holds F.t. already: --at"),
    (["experiment.csv", "cell.feb", "--order", "2"], 'hold no "G"'),
    (["tissue.nc", "--at", "0,0,0", "--overlay", "--dataset", "s.nc"], "makes no series"),
])
def test_bad_requests_are_named(folder, args, message):
    with pytest.raises(InputError, match=message):
        run(folder, *args)


def test_help_does_not_import_scipy_or_xarray():
    code = ("import sys; from febkit.cli.boundary import command\n"
            "assert not {'scipy', 'xarray', 'numpy', 'numba'} & set(sys.modules), sorted(sys.modules)")
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(("last", "said"), [
    (1.0, []), (5.0, ["the cell model ends at t = 1, the hand-off at 5: for more of it, give"]),
    (0.5, ["the hand-off ends at t = 0.5, the cell model at 1: from there on its surface stays"]),
])  # fmt: skip
def test_where_cell_model_and_hand_off_end_apart_is_said(folder, last, said):
    (folder / "experiment.csv").write_text(f"time,Fzz,p\n0,1,0\n{last},0.9,0.2\n")
    told = run(folder, "experiment.csv", "cell.feb", "-o", "d.feb")
    told = " ".join(told.split())
    assert told.count(" ends at t") == len(said) and all(s in told for s in said)

"""``ds.febkit`` on a solved plotfile: each answer against what the solution must obey."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
import xarray as xr

import febkit
from febkit.model import InputError
from febkit.results import mesh as meshes

E, NU, STRETCH = 2.0, 0.3, 0.1


def bar(path: Path) -> None:
    """A bar 1 x 1 x 2 in two parts of 2 x 2 x 2 hexahedra each, ids from 101 and 501, drawn out along z."""
    n = 2
    ids, lines = {}, []
    for k in range(2 * n + 1):
        for j in range(n + 1):
            for i in range(n + 1):
                ids[i, j, k] = 101 + len(ids)
                lines.append(f'<node id="{ids[i, j, k]}">{i / n},{j / n},{k / n}</node>')
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    parts: dict[str, list[str]] = {"below": [], "above": []}
    count = 500
    for k in range(2 * n):
        for j in range(n):
            for i in range(n):
                count += 1
                nodes = ",".join(str(ids[i + a, j + b, k + c]) for a, b, c in corners)
                parts["below" if k < n else "above"].append(f'<elem id="{count}">{nodes}</elem>')
    sets = {"bottom": lambda i, j, k: k == 0, "top": lambda i, j, k: k == 2 * n, "left": lambda i, j, k: i == 0,
            "front": lambda i, j, k: j == 0}  # fmt: skip
    named = {s: ",".join(str(v) for p, v in ids.items() if inside(*p)) for s, inside in sets.items()}
    facets = "".join(
        f'<quad4 id="{1 + j * n + i}">{ids[i, j, 2 * n]},{ids[i + 1, j, 2 * n]},{ids[i + 1, j + 1, 2 * n]},'
        f"{ids[i, j + 1, 2 * n]}</quad4>" for j in range(n) for i in range(n)
    )  # fmt: skip
    bcs = "".join(f'<bc type="zero displacement" node_set="{s}"><{d}_dof>1</{d}_dof></bc>'
                  for s, d in (("bottom", "z"), ("left", "x"), ("front", "y")))  # fmt: skip
    wanted = ("displacement", "reaction forces", "stress", "Lagrange strain", "relative volume")
    variables = "".join(f'<var type="{v}"/>' for v in wanted)
    path.write_text(f"""<?xml version="1.0"?>
<febio_spec version="4.0"><Module type="solid"><units>mm-N-s</units></Module>
<Control><analysis>STATIC</analysis><time_steps>2</time_steps><step_size>0.5</step_size>
<solver type="solid"><dtol>1e-6</dtol><etol>1e-12</etol><rtol>0</rtol></solver></Control>
<Material><material id="1" name="soft" type="neo-Hookean"><density>1</density><E>{E}</E><v>{NU}</v></material>
</Material>
<Mesh><Nodes name="all">{"".join(lines)}</Nodes>
{"".join(f'<Elements type="hex8" name="{p}">{"".join(e)}</Elements>' for p, e in parts.items())}
{"".join(f'<NodeSet name="{s}">{v}</NodeSet>' for s, v in named.items())}
<Surface name="face">{facets}</Surface></Mesh>
<MeshDomains>{"".join(f'<SolidDomain name="{p}" mat="soft"/>' for p in parts)}</MeshDomains>
<Boundary>{bcs}<bc type="prescribed displacement" node_set="top"><dof>z</dof><value lc="1">{2 * STRETCH}</value>
<relative>0</relative></bc></Boundary>
<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>
<Output><plotfile type="febio">{variables}</plotfile></Output></febio_spec>""")


@pytest.fixture(scope="module")
def ds(tmp_path_factory) -> xr.Dataset:
    path = tmp_path_factory.mktemp("bar") / "bar.feb"
    bar(path)
    assert febkit.solve(febkit.read(path), path.with_suffix(".xplt")).converged
    return febkit.open_results(path.with_suffix(".xplt"))


def axial() -> tuple[float, float]:
    """Stretch across and axial Cauchy stress of the neo-Hookean bar at its end: stress across is zero."""
    from scipy.optimize import brentq

    mu, lam, z = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU)), 1 + STRETCH

    def stress(across: float, a: float) -> float:
        J = across**2 * z
        return (mu * (a**2 - 1) + lam * np.log(J)) / J

    across = brentq(lambda x: stress(x, x), 0.8, 1.1, xtol=1e-14)
    return across, stress(across, z)


def test_reactions_balance_and_are_stress_times_area(ds: xr.Dataset) -> None:
    across, stress = axial()
    top, bottom, face = (ds.febkit.reaction(n) for n in ("top", "bottom", "face"))
    assert top.dims == ("time", "xyz") and top.attrs["units"] == "N"
    assert abs(float(top[-1, 2])) == pytest.approx(stress * across**2, rel=1e-5)
    np.testing.assert_allclose(top + bottom, 0, atol=1e-6)
    np.testing.assert_array_equal(top, face)
    with pytest.raises(InputError, match=r"no node set or surface is called 'lid'.*bottom, top, left, front, face"):
        ds.febkit.reaction("lid")
    with pytest.raises(InputError, match='add <var type="reaction forces"/>'):
        ds.drop_vars("reaction_forces").febkit.reaction("top")


def test_tensors(ds: xr.Dataset) -> None:
    across, stress = axial()
    p = ds.febkit.principal("stress")
    assert p.dims == ("time", "element", "principal") and p.attrs["units"] == "MPa"
    np.testing.assert_allclose(p.isel(time=-1), np.broadcast_to([stress, 0, 0], (16, 3)), atol=1e-6)
    v = ds.febkit.von_mises("stress")
    assert float(v.sel(element=505)[-1]) == pytest.approx(stress, rel=1e-5)
    strain = ds.febkit.principal("Lagrange strain").isel(time=-1)
    np.testing.assert_allclose(strain[:, 0], ((1 + STRETCH) ** 2 - 1) / 2, rtol=1e-5)
    np.testing.assert_allclose(strain[:, 2], (across**2 - 1) / 2, rtol=1e-4)
    with pytest.raises(InputError, match="those of this result: stress, Lagrange_strain"):
        ds.febkit.von_mises("displacement")


def test_means_and_quantiles(ds: xr.Dataset) -> None:
    across, stress = axial()
    m = ds.febkit.mean("stress", part="above")
    assert m.dims == ("time", "voigt") and m.attrs["units"] == "MPa"
    assert float(m.sel(voigt="zz")[-1]) == pytest.approx(stress, rel=1e-5)
    assert float(ds.febkit.mean("relative volume")[-1]) == pytest.approx(across**2 * (1 + STRETCH), rel=1e-5)
    assert float(ds.febkit.mean("displacement:z", "below")[-1]) == pytest.approx(STRETCH / 2, rel=1e-5)
    assert float(ds.febkit.mean("displacement")[-1].sel(xyz="z")) == pytest.approx(STRETCH, rel=1e-5)
    q = ds.febkit.quantile("stress:effective", [0.05, 0.95], part="above")
    assert q.dims == ("time", "quantile") and q.attrs["units"] == "MPa"
    np.testing.assert_allclose(q[-1], stress, rtol=1e-5)
    assert ds.febkit.quantile("displacement:z", 0.5)[-1] == pytest.approx(STRETCH, rel=1e-4)
    with pytest.raises(InputError, match="between 0 and 1"):
        ds.febkit.quantile("stress:zz", 5)
    with pytest.raises(InputError, match="no part or element set is called 'middle'"):
        ds.febkit.mean("stress", "middle")


def test_subsets(ds: xr.Dataset) -> None:
    part = ds.febkit.part("above")
    assert (part.sizes["element"], part.sizes["node"]) == (8, 27) and part.attrs["parts"] == ["above"]
    assert part["element"].values.tolist() == list(range(509, 517)) and part["X"].values[:, 2].min() == 1
    whole = ds["X"].values[ds["connectivity"].values[8:]]
    np.testing.assert_array_equal(part["X"].values[part["connectivity"].values], whole)
    assert meshes.of(part).blocks[0].part == "above"
    assert float(part.febkit.mean("stress:zz")[-1]) == float(ds.febkit.mean("stress:zz", "above")[-1])
    top = ds.febkit.node_set("top")
    assert top.sizes["node"] == 9 and set(top.data_vars) == {"displacement", "reaction_forces"}
    np.testing.assert_allclose(top["displacement"][-1].sel(xyz="z"), 2 * STRETCH, rtol=1e-6)
    face = ds.febkit.surface("face")
    assert face.sizes["facet"] == 4 and face.sizes["node"] == 9
    assert (face["X"].values[face["facets"].values][:, :, 2] == 2).all()
    with pytest.raises(InputError, match="no surface is called 'bottom'"):
        ds.febkit.surface("bottom")


def test_nodes_and_elements_by_febio_id(ds: xr.Dataset) -> None:
    for number in (101, 113, 145):
        one = ds.febkit.node(number)
        assert int(one["node"]) == number
        np.testing.assert_array_equal(one["displacement"], ds["displacement"].isel(node=number - 101))
    element = ds.febkit.element(510)
    np.testing.assert_array_equal(element["stress"], ds["stress"].isel(element=9))
    with pytest.raises(InputError, match="no node 1: ids are 101 to 145"):
        ds.febkit.node(1)


def test_probes_use_shape_functions(ds: xr.Dataset) -> None:
    """The motion is linear, so that any point follows it exactly; the nearest node does not."""
    across, stress = axial()
    points = np.array([[0.13, 0.77, 1.61], [0.5, 0.5, 1.0], [0.9, 0.1, 0.05], [1.0, 1.0, 2.0]])
    got = ds.febkit.probe(points)
    assert got["displacement"].dims == ("time", "point", "xyz") and got["displacement"].attrs["units"] == "mm"
    want = points * [across - 1, across - 1, STRETCH]
    np.testing.assert_allclose(got["displacement"][-1], want, atol=2e-7)
    np.testing.assert_allclose(got["stress"][-1, :, 2], stress, rtol=1e-5)
    for number, x in zip(got["element_id"].values, points):
        element = ds.febkit.element(int(number))["X"].values
        assert (element.min(axis=0) - 1e-9 <= x).all() and (x <= element.max(axis=0) + 1e-9).all()
    assert set(ds.febkit.probe([0.5, 0.5, 0.5], ["relative volume"]).data_vars) == {"relative_volume"}
    with pytest.raises(InputError, match="1 of 2 points outside"):
        ds.febkit.probe([[0.5, 0.5, 0.5], [0, 0, 3]])
    with pytest.raises(InputError, match="three finite numbers"):
        ds.febkit.probe([[0.5, 0.5]])


def test_deformed_and_paraview(ds: xr.Dataset, tmp_path: Path) -> None:
    x = ds.febkit.deformed()
    assert float(x.sel(xyz="z").max()) == pytest.approx(2 + 2 * STRETCH) and x.attrs["units"] == "mm"
    half = ds.febkit.deformed(0.5)
    assert float(half.sel(xyz="z").max()) == pytest.approx(2 + STRETCH)
    with pytest.raises(InputError, match=r"no state at t = 0\.3; the nearest is 0\.5"):
        ds.febkit.deformed(0.3)
    mesh = ds.febkit.to_meshio(0.5, deformed=True)
    assert mesh.points[:, 2].max() == pytest.approx(2 + STRETCH) and "stress" in mesh.cell_data
    files = ds.febkit.write_vtk(tmp_path / "run.pvd", variables=["displacement", "relative volume"])
    assert files[0].name == "run.pvd" and len(files) == 1 + ds.sizes["time"]
    back = meshio.read(files[-1])
    np.testing.assert_array_equal(back.point_data["displacement"], ds["displacement"][-1])
    pytest.importorskip("pyvista")
    grid = ds.febkit.to_pyvista()
    assert grid.n_cells == 16 and "stress" in grid.cell_data


def test_netcdf_and_parts_answer_alike(ds: xr.Dataset, tmp_path: Path) -> None:
    febkit.results.write(ds, tmp_path / "a.nc")
    back = febkit.open_results(tmp_path / "a.nc")
    np.testing.assert_array_equal(back.febkit.reaction("top"), ds.febkit.reaction("top"))
    np.testing.assert_array_equal(back.febkit.mean("stress", "above"), ds.febkit.mean("stress", "above"))
    np.testing.assert_array_equal(back.sel(node=113)["displacement"], ds.sel(node=113)["displacement"])
    febkit.results.write(ds.febkit.part("above"), tmp_path / "above.xplt")
    above = febkit.open_results(tmp_path / "above.xplt")
    np.testing.assert_array_equal(above["stress"], ds["stress"][:, 8:])
    np.testing.assert_array_equal(above["node"], ds.febkit.part("above")["node"])


def test_the_force_on_a_rigid_part(ds: xr.Dataset, tmp_path: Path) -> None:
    """FEBio writes it by part, "rigid force"; a file made of the solved one stands in."""
    force = np.zeros((ds.sizes["time"], 2, 3), np.float32)
    force[:, 1, 2] = [0, 1, 2]
    attrs = {"febio_name": "rigid force", "febio_section": "domain", "febio_type": "vec3f", "febio_format": "region"}
    febkit.results.write(ds.assign(rigid_force=(("time", "domain", "xyz"), force, attrs)), tmp_path / "a.xplt")
    with febkit.open_results(tmp_path / "a.xplt") as found:
        np.testing.assert_array_equal(found.febkit.reaction("above").sel(xyz="z"), [0, 1, 2])
        assert found.febkit.reaction("below").attrs["units"] == "N"


def test_xarray_itself_finds_it(ds: xr.Dataset) -> None:
    code = (f"import xarray as xr; ds = xr.open_dataset({ds.encoding['source']!r}, engine='febkit' if 'febkit' in "
            "xr.backends.list_engines() else __import__('febkit.results.backend', fromlist=['x']).PlotfileBackend); "
            "print(ds.febkit.node(101)['displacement'].shape)")  # fmt: skip
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "(3, 3)"

"""Figures are drawn without a display and hold what they should."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

pytest.importorskip("matplotlib")

import febkit
from febkit import plots
from febkit.metrics import METRICS, cell_metrics, compare
from febkit.model import InputError

TIMES = (0.0, 0.05, 0.1, 1.0, 5.0, 100.0)


def metrics(seed: int) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    shape = np.tanh(np.array(TIMES))
    data = {m: (("cell", "time"), (1 + rng.normal(0, 0.1, (4, 1))) * shape, {"units": "1"}) for m in METRICS}
    return xr.Dataset(data, coords={"cell": [f"cell{i}" for i in range(4)], "time": list(TIMES)})


def block(n: int = 4) -> xr.Dataset:
    """A unit cube of n^3 hexahedra in two parts, sheared in time."""
    a = np.linspace(0, 1, n + 1)
    X = np.stack(np.meshgrid(a, a, a, indexing="ij"), -1).reshape(-1, 3)
    i, j, k = (g.ravel() for g in np.meshgrid(*[np.arange(n)] * 3, indexing="ij"))
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    conn = np.stack([((i + p) * (n + 1) + j + q) * (n + 1) + k + r for p, q, r in corners], axis=1)
    u = np.stack([np.column_stack([0.2 * t * X[:, 2], 0 * X[:, 0], -0.1 * t * X[:, 2]]) for t in (0.0, 1.0)])
    flux = np.zeros((2, n**3, 3))
    flux[1, :, 2] = 1
    coords = {
        "time": [0.0, 1.0], "xyz": ["x", "y", "z"], "X": (("node", "xyz"), X),
        "node_id": ("node", np.arange(len(X)) + 1), "element_id": ("element", np.arange(n**3) + 1),
        "part": ("element", (i >= n // 2).astype(int)), "element_type": ("element", np.zeros(n**3, int)),
        "connectivity": (("element", "local"), conn),
    }
    data = {"displacement": (("time", "node", "xyz"), u), "fluid_flux": (("time", "element", "xyz"), flux)}
    return xr.Dataset(data, coords, {"parts": ["ecm", "cell1"], "element_types": ["hex8"]})


def test_histories_have_a_line_for_each_cell(tmp_path):
    figure = plots.histories({"control": metrics(0), "order 1": metrics(1)})
    assert len(figure.axes) == 12
    # four cells and the zero line
    assert all(len(ax.lines) == 5 for ax in figure.axes)
    plots.save(figure, tmp_path / "h.png")
    assert (tmp_path / "h.png").read_bytes()[:4] == b"\x89PNG"


def test_early_exchange_stops_at_one_second():
    figure = plots.early_exchange({"control": metrics(0)})
    assert figure.axes[0].get_xlim() == (0, 1)
    assert figure.axes[0].lines[0].get_xdata().max() == 1


def test_bars_show_the_counts(tmp_path):
    a, b = metrics(0), metrics(1)
    b["effective_strain"][2, 3] += 9
    agreed = {"A": {"1": compare(a, b), "2": compare(a, a * 1.01)}}
    figure = plots.outside_counts(agreed)
    heights = [bar.get_height() for bar in figure.axes[list(METRICS).index("effective_strain")].patches]
    figure.draw_without_rendering()
    legend = figure.legends[0].get_window_extent()
    assert not any(legend.overlaps(ax.get_window_extent()) for ax in figure.axes)
    assert heights[0] == int(compare(a, b).outside.sel(metric="effective_strain"))
    plots.save(plots.errors(agreed), tmp_path / "e.svg")
    plots.save(plots.bland_altman(a, b), tmp_path / "b.pdf")


def test_convergence_prints_the_measured_order():
    h = np.array([0.1, 0.05, 0.025])
    figure = plots.convergence(h, {"u": 3 * h**2})
    assert "u: 2.00" in figure.axes[0].get_legend().get_texts()[0].get_text()


@pytest.mark.parametrize("at", [0.3, 0.5])
def test_a_section_covers_the_plane_once(at):
    """Polygon areas add up to the deformed section, a parallelogram of width 1 and height 0.9."""
    for normal in "yx":
        s = plots.cut(block(), 1, normal, at)
        x, y = s.corners[..., 0], s.corners[..., 1]
        area = 0.0
        for p in s.polygons():
            area += 0.5 * abs(np.dot(p[:, 0], np.roll(p[:, 1], -1)) - np.dot(p[:, 1], np.roll(p[:, 0], -1)))
        if normal == "y":
            assert area == pytest.approx(0.9, rel=1e-9)
        assert np.isfinite(x).any() and np.isfinite(y).any()


def test_sections_side_by_side(tmp_path):
    febkit.results.write(block().assign_attrs(unit_system="mm-N-s"), tmp_path / "a.xplt")
    ds = febkit.open_results(tmp_path / "a.xplt")
    figure = plots.sections({"a": (ds, None), "b": (ds, None)}, time=1.0, at=0.4)
    values = figure.axes[0].collections[0].get_array()
    exact = float(cell_metrics(ds)["effective_strain"][0, 1])
    assert np.allclose(values, exact)
    assert figure.axes[0].get_xlabel() == "x (mm)" and figure.axes[0].get_ylabel() == "z (mm)"
    stress = plots.sections({"a": (ds, None)}, "volume", time=1.0, at=0.4)
    assert stress.axes[-1].get_ylabel() == "volume (µm³)"
    plots.save(figure, tmp_path / "s.png")
    with pytest.raises(InputError, match="nearest"):
        plots.sections({"a": (ds, None)}, time=0.5)
    with pytest.raises(InputError, match="no element"):
        plots.sections({"a": (ds, None)}, time=1.0, at=7.0)
    flux = plots.sections({"a": (ds, None)}, "fluid flux:z", time=1.0, at=0.4)
    assert np.allclose(flux.axes[0].collections[0].get_array(), 1)
    with pytest.raises(InputError, match="scalar"):
        plots.sections({"a": (ds, None)}, field="volume:x", time=1.0)
    of_all = plots.sections({"a": (ds, None)}, "fluid_flux", time=1.0, at=0.4)  # a vector without a component
    assert of_all.axes[-1].get_ylabel().startswith("fluid flux, magnitude")
    assert np.allclose(of_all.axes[0].collections[0].get_array(), 1)
    with pytest.raises(InputError, match=r"fluid_flux:x"):
        plots.sections({"a": (ds, None)}, field="fluid_flux:w", time=1.0)


def test_nodal_values_are_linear_across_a_section():
    """u_z = -0.1 z of the reference: at height y of the deformed section u_z = -y/9."""
    figure = plots.sections({"a": (block(), None)}, "displacement:z", time=1.0, at=0.3)
    mesh = figure.axes[0].collections[0]
    triangles = mesh._triangulation
    assert np.allclose(mesh.get_array(), -triangles.y / 9, atol=1e-12)


def tensor_block():
    """A stress whose principal values are known: 3, 2, 1 in turned axes, times the element's number."""
    ds = block(2).assign_attrs(unit_system="mm-N-s")
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    s = turn @ np.diag([3.0, 2.0, 1.0]) @ turn.T
    voigt = np.array([s[0, 0], s[1, 1], s[2, 2], s[0, 1], s[1, 2], s[0, 2]])
    v = np.stack([np.zeros((8, 6)), np.arange(1, 9)[:, None] * voigt])
    ds["stress"] = (("time", "element", "voigt"), v, {"units": "MPa"})
    ds = ds.assign_coords(voigt=["xx", "yy", "zz", "xy", "yz", "xz"])
    ds["reaction_forces"] = (("time", "node", "xyz"), np.ones((2, 27, 3)), {"units": "N"})
    return ds


def test_xy_draws_parts_ids_and_principal_values(tmp_path):
    ds = tensor_block()
    figure = plots.xy(ds, ["stress:first", "stress:second"], parts=["ecm", "cell1"], elements=[5])
    top, middle = figure.axes
    assert [t.get_text() for t in top.get_legend().get_texts()] == ["ecm", "cell1", "element 5"]
    assert top.get_ylabel() == "mean of stress, 1st principal value (MPa)"
    assert [line.get_ydata()[-1] for line in top.lines] == pytest.approx([3 * 2.5, 3 * 6.5, 15])
    assert [line.get_ydata()[-1] for line in middle.lines] == pytest.approx([2 * 2.5, 2 * 6.5, 10])
    forces = plots.xy(ds, "reaction forces:z", x="displacement:z", nodes=[27])
    assert forces.axes[0].lines[0].get_xdata() == pytest.approx([0, -0.1])
    whole = plots.xy(ds, "reaction forces:z")
    assert whole.axes[0].lines[0].get_ydata() == pytest.approx([27, 27])
    assert plots.xy(ds, "reaction forces:z", take="greatest").axes[0].lines[0].get_ydata() == pytest.approx([1, 1])
    strain = plots.xy(ds, "effective_strain", parts=["ecm"])
    assert strain.axes[0].lines[0].get_ydata()[-1] == pytest.approx(float(cell_metrics(ds)["effective_strain"][0, 1]))
    for bad, options, words in (
        ("stres", {}, "the result has no 'stres'"), ("stress:zx", {}, "say which component"),
        ("stress", {"nodes": [1]}, "lives on elements"), ("stress", {"take": "median"}, "none of"),
        ("stress", {"elements": [99]}, "no element 99"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            plots.xy(ds, bad, **options)


def test_figures_show_themselves_and_legends_have_names():
    figure = plots.histories({"control": metrics(0), "order 1": metrics(1)})
    assert figure._repr_png_()[:4] == b"\x89PNG"
    assert [t.get_text() for t in figure.legends[0].get_texts()] == ["cell0", "cell1", "cell2", "cell3"]
    agreed = plots.bland_altman(metrics(0), metrics(1))
    assert "95 % limits of agreement" in [t.get_text() for t in agreed.legends[0].get_texts()]


def test_a_single_bar_is_no_wall():
    figure = plots.errors({"control": {"cells": compare(metrics(0), metrics(1))}})
    ax = figure.axes[0]
    assert ax.patches[0].get_width() < 0.5 * np.ptp(ax.get_xlim())
    assert figure.get_figwidth() < 8

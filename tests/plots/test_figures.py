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
    assert "(2.00)" in figure.axes[0].get_legend().get_texts()[0].get_text()


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
    assert stress.axes[-1].get_ylabel() == "volume (um^3)"
    plots.save(figure, tmp_path / "s.png")
    with pytest.raises(InputError, match="nearest"):
        plots.sections({"a": (ds, None)}, time=0.5)
    with pytest.raises(InputError, match="no element"):
        plots.sections({"a": (ds, None)}, time=1.0, at=7.0)
    with pytest.raises(InputError, match="scalar"):
        plots.sections({"a": (ds, None)}, field="fluid_flux", time=1.0)

"""Arrays over the species of a mixture: a dimension of their own, named, also where there is one of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from febkit.results import open as open_results
from febkit.results.rewrite import write
from febkit.results.xplt.records import PlotVariable


def variables(solutes: tuple[str, ...], bound: tuple[str, ...] = ()) -> list[PlotVariable]:
    n = len(solutes)
    out = [
        PlotVariable("effective solute concentration", "domain", "array", "node", n, "n/L^3", solutes),
        PlotVariable("solute concentration", "domain", "array", "item", n, "n/L^3", solutes),
        PlotVariable("solute flux", "domain", "array vec3f", "item", n, None, solutes),
    ]
    if bound:
        out.append(PlotVariable("sbm concentration", "domain", "array", "item", len(bound), None, bound))
    return out


@pytest.mark.parametrize("solutes", [("Na+", "Cl-"), ("glucose",)])
def test_concentrations_lie_over_solutes_by_name(random_plot, tmp_path: Path, solutes: tuple[str, ...]) -> None:
    path = tmp_path / "m.xplt"
    random_plot(path, variables=variables(solutes, ("aggrecan",)))
    with open_results(path) as ds:
        assert ds["effective_solute_concentration"].dims == ("time", "node", "solute")
        assert ds["solute_concentration"].dims == ("time", "element", "solute")
        assert ds["solute_flux"].dims == ("time", "element", "solute", "xyz")
        assert ds["sbm_concentration"].dims == ("time", "element", "solid_bound")
        assert ds["solute"].values.tolist() == list(solutes)
        assert ds["solid_bound"].values.tolist() == ["aggrecan"]
        one = ds["solute_concentration"].sel(solute=solutes[-1])
        assert np.array_equal(one.values, ds["solute_concentration"].values[..., -1])


def test_arrays_without_names_are_numbered(random_plot, tmp_path: Path) -> None:
    path = tmp_path / "m.xplt"
    random_plot(path, variables=[PlotVariable("solute concentration", "domain", "array", "item", 2)])
    with open_results(path) as ds:
        assert ds["solute"].values.tolist() == ["solute 1", "solute 2"]


def test_names_that_differ_keep_a_dimension_of_their_own(random_plot, tmp_path: Path) -> None:
    path = tmp_path / "m.xplt"
    other = PlotVariable("partition coefficient", "domain", "array", "item", 1, None, ("K+",))
    random_plot(path, variables=[*variables(("Na+", "Cl-")), other])
    with open_results(path) as ds:
        assert ds["partition_coefficient"].dims == ("time", "element", "partition_coefficient_item")


def test_a_dataset_goes_back_into_the_same_plotfile(random_plot, tmp_path: Path) -> None:
    path, again = tmp_path / "m.xplt", tmp_path / "again.xplt"
    random_plot(path, variables=variables(("glucose",)))
    with open_results(path) as ds:
        c = ds["solute_concentration"]
        twice = ds.assign(partition_coefficient=(c.dims, 2 * c.values))
        write(twice, again)
        with open_results(again) as back:
            for name in ("effective_solute_concentration", "solute_concentration", "solute_flux"):
                xr.testing.assert_equal(back[name], ds[name])
            assert np.array_equal(back["partition_coefficient"].values, 2 * c.values)

"""Concentrations handed off beside displacement and pressure: series, forms of conditions, driving data, checks."""

from dataclasses import replace

import numpy as np
import pytest

from febkit.coupling import check, drive, handoff, overlay, read_driving, series, surface_nodes, write
from febkit.feb import read
from febkit.model import Component, InputError, NodeSet

from .conftest import Polynomial, field
from .test_boundary import TIMES, cell, leaf, values_of

AT = np.array([0.1, 0.05, -0.1])
CHARGES = {"Na": 1, "Cl": -1}


def charged(n=3, degree=3, kind="hex27"):
    """A tissue whose concentrations are polynomials of a degree, at all times of TIMES."""
    f = field(kind, n, Polynomial(degree, 1), lambda x: Polynomial(degree, 2, 1)(x)[:, 0])
    wave = np.cos(TIMES)
    c = np.stack([150.0 + Polynomial(degree, 3 + k, 1)(f.X)[:, 0] for k in range(2)], axis=-1)
    return replace(f, times=TIMES, u=wave[:, None, None] * f.u[1], p=wave[:, None] * f.p[1],
                   c=(1 + 0.1 * wave)[:, None, None] * c, solutes=("Na", "Cl"))


def mixture(names=("Na", "Cl"), boundary=(), ids=(1, 2, 3)):
    """A cell model of a multiphasic module whose solutes are ``names``."""
    table = Component("Solutes", children=tuple(
        Component("solute", name=n, id=k, children=(leaf("charge_number", CHARGES.get(n, 0)),))
        for k, n in zip(ids, names)))
    return replace(cell("multiphasic", boundary), unknown=(Component("Globals", children=(table,)),))


def at_nodes(X, k, degree=3):
    """Concentration k of the tissue at places X from AT, by the polynomial itself, at all times (t, n)."""
    base = 150.0 + Polynomial(degree, 3 + k, 1)(X + AT)[:, 0]
    return (1 + 0.1 * np.cos(TIMES))[:, None] * base


@pytest.mark.parametrize(("order", "recovery"), [  # a triquadratic element has no pure third derivatives of its own
    (1, "element"), (2, "element"), (1, "polynomial"), (2, "polynomial"), (3, "polynomial")])
def test_polynomials_of_the_order_are_handed_off_exactly(order, recovery):
    f = charged(degree=order)
    X = cell().mesh.X
    h = handoff(series(f, AT, order=order, recovery=recovery), X, order=order, fluid_order=order, solute_order=order)
    for k in range(2):
        assert np.abs(h.c[..., k] - at_nodes(X, k, order)).max() < 1e-9


def test_orders_are_chosen_apart():
    ds = series(charged(), AT, order=3, recovery="polynomial")
    assert ds["c"].dims == ("point", "time", "solute") and ds["H_c"].dims[2:] == ("solute", "J", "K")
    X = cell().mesh.X
    h = handoff(ds, X, order=2)
    assert (h.motion.shape[1], h.fluid.shape[1], h.concentration.shape[1]) == (10, 10, 10)
    h = handoff(ds, X, order=3, fluid_order=1, solute_order=0)
    assert (h.motion.shape[1], h.fluid.shape[1], h.concentration.shape[1]) == (20, 4, 1)
    with pytest.raises(InputError, match="solute order must be"):
        handoff(ds, X, solute_order=4)


@pytest.mark.parametrize(("origin", "names", "ids"), [
    ((0, 0, 0), ("Cl", "Na"), (1, 2)), ((0.01, -0.02, 0.0), ("Cl", "Na"), (1, 2)), ((0, 0, 0), ("Na", "Cl"), (2, 1))])
def test_conditions_give_the_histories_by_the_solutes_names(origin, names, ids):
    """The cell model numbers its solutes otherwise; the solute, not the number, decides."""
    model = mixture(names, ids=ids)
    nodes = surface_nodes(model.mesh)
    h = handoff(series(charged(), AT, order=3, recovery="polynomial"), model.mesh.X[nodes], order=2, origin=origin)
    made = drive(model, h, nodes)
    assert [c.type for c in made.model.common.boundary][3:] == [
        "prescribed fluid pressure", "prescribed concentration", "prescribed concentration"]
    for t in (0.0, 0.17, 100.0):
        got = values_of(made.model, t)
        for dof, k in (("c1", 1), ("c2", 0)):
            wanted = [np.interp(t, TIMES, h.c[:, n, k]) for n in range(len(nodes))]
            assert np.abs(got[dof] - wanted).max() < 1e-11


@pytest.mark.parametrize("version", ["4.0", "3.0", "2.5"])
def test_curves_carry_concentrations_in_every_version(version, tmp_path):
    model = mixture()
    nodes = surface_nodes(model.mesh)
    h = overlay(charged(), model.mesh.X[nodes], AT)
    write(drive(model, h, nodes, version=version), tmp_path / "m.feb", version)
    back = read(tmp_path / "m.feb")
    curves = {c.id: np.array(c.points) for c in back.controllers}
    place = {n: k for k, n in enumerate(nodes.tolist())}
    found = [c for c in back.common.boundary if c.type == "prescribed concentration"]
    assert len(found) == 2 * len(nodes)
    for c in found:
        at = place[int(back.mesh.node_sets[c.attrs["node_set"]].nodes[0])]
        points = curves[c.need("value").lc]
        assert np.array_equal(points[:, 1], h.c[:, at, int(c.str("dof")[1:]) - 1])


def test_an_overlay_is_the_tissue_itself():
    X = cell().mesh.X
    h = overlay(charged(degree=2), X, AT)
    for k in range(2):
        assert np.abs(h.c[..., k] - at_nodes(X, k, 2)).max() < 1e-9


def test_a_solute_that_the_tissue_lacks_is_named():
    model = mixture(("Na", "glucose"))
    nodes = surface_nodes(model.mesh)
    h = handoff(series(charged(), AT, order=1), model.mesh.X[nodes], order=1)
    with pytest.raises(InputError, match='no solute "glucose": there are Na, Cl'):
        drive(model, h, nodes)


def test_conditions_on_concentrations_are_replaced_where_they_are_handed_off():
    skin = surface_nodes(cell().mesh)
    bath = Component("bc", "prescribed concentration", attrs={"node_set": "skin"},
                     children=(leaf("dof", "c1"), leaf("value", 150)))
    model = mixture(boundary=[bath])
    model = replace(model, mesh=replace(model.mesh, node_sets={"skin": NodeSet("skin", skin)}))
    X = model.mesh.X[skin]
    dry = field("hex8", 3, Polynomial(1, 1), lambda x: x[:, 0])
    kept = drive(model, handoff(series(dry, AT, order=1), X, order=1), skin)
    assert any(c.children[1].text == "150" for c in kept.model.common.boundary)  # nothing was handed off for it
    gone = drive(model, handoff(series(charged(), AT, order=1), X, order=1), skin)
    assert 'replaced <bc type="prescribed concentration"> on "skin"' in gone.said


def test_a_biphasic_cell_takes_no_solutes():
    model = cell()
    nodes = surface_nodes(model.mesh)
    made = drive(model, handoff(series(charged(), AT, order=1), model.mesh.X[nodes], order=1), nodes)
    assert len(made.model.common.boundary) == 4


def test_columns_of_a_csv_name_solutes(tmp_path):
    path = tmp_path / "e.csv"
    path.write_text("time,Fzz,p,c[Na+],c[Cl-],c[Na+]z,c[Na+]xz\n0,1,0,150,150,0,0\n2,0.9,0.1,160,140,5,2\n")
    ds = read_driving(path)
    assert ds["solute"].values.tolist() == ["Na+", "Cl-"]
    assert ds["c"].values[0].tolist() == [[150, 150], [160, 140]]
    assert ds["grad_c"].values[0, 1].tolist() == [[0, 0, 5], [0, 0, 0]]
    assert ds["H_c"].values[0, 1, 0].tolist() == [[0, 0, 2], [0, 0, 0], [2, 0, 0]]
    path.write_text("time,Fzz,c[Na\n0,1,150\n2,0.9,160\n")
    with pytest.raises(InputError, match=r"c\[solute\]"):
        read_driving(path)


def test_what_is_left_out_is_estimated_for_concentrations_too():
    ds = series(charged(), AT, order=3, recovery="polynomial")
    X = cell().mesh.X
    given = handoff(ds, X, order=2, solute_order=1)
    found = check(given, ds)
    true = max(np.abs(given.c[..., k] - at_nodes(X, k)).max() / np.abs(given.c[..., k]).max() for k in range(2))
    assert 0.3 * true < found.remainder_c < 3 * true
    low = ds.copy()
    low["c"] = low["c"] - low["c"].max()
    problems = check(handoff(low, X, order=2, solute_order=1), low).problems
    assert any("turns negative" in p for p in problems)


def test_the_error_of_concentrations_is_estimated_beside():
    """Quadratic concentrations handed off by their linear parts: the estimate is what is left out."""
    from febkit.coupling import errors, estimate

    X = errors.lattice(0.2)
    ds = series(charged(degree=2, kind="hex20"), AT, order="auto", box=0.2, recovery="polynomial")
    found = estimate(ds, 0, 2, 2, 1)
    given = handoff(ds, X, order=2, fluid_order=2, solute_order=1)
    true = np.stack([given.c[..., k] - at_nodes(X, k, 2) for k in range(2)], axis=-1)
    assert found["c_error"].values == pytest.approx(np.linalg.norm(true, axis=-1).max(axis=1), rel=1e-6)
    assert int(ds["solute_order"][0]) >= 2
    assert any("concentrations" in line for line in check(given, ds).lines if "estimated error" in line)

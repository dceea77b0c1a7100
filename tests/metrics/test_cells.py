"""Cell metrics against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.metrics import METRICS, cell_metrics, element_fields, tensors
from febkit.metrics.sources import Sources
from febkit.metrics.tensors import effective, max_difference, principal
from febkit.model import Component, Domain, InputError, Mesh, Model

KINDS = ("hex8", "hex20", "hex27", "tet4", "tet10", "tet15", "penta6", "penta15", "pyra5")


def model(parts: list[str], E: float = 0.001, v: float = 0.4, k: float = 0.001) -> Model:
    """A biphasic material on every part."""
    number = lambda tag, x: Component(tag, text=repr(x))  # noqa: E731
    mat = Component(
        "material",
        type="biphasic",
        name="cell",
        id=1,
        children=(
            Component("solid", type="neo-Hookean", children=(number("E", E), number("v", v))),
            Component("permeability", type="perm-const-iso", children=(number("perm", k),)),
        ),
    )
    mesh = Mesh(np.zeros(0, int), np.zeros((0, 3)))
    return Model("4.0", "biphasic", mesh, (mat,), tuple(Domain(p, "solid", "cell") for p in parts))


def rotation(seed: int = 3) -> np.ndarray:
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


STRETCH = np.diag([0.8, 1.1, 1.3])


@pytest.mark.parametrize("turn", [np.eye(3), rotation()])
def test_affine_stretch_of_a_sphere(mesh, make, turn):
    X, conn = mesh(6)
    F = turn @ STRETCH
    move = lambda X, t: X @ (F if t else np.eye(3)).T + t * np.array([5.0, 1, 2])  # noqa: E731
    ds = make(X, [("hex8", "cell1", conn)], move)
    m = cell_metrics(ds, model(["cell1"])).isel(cell=0, time=1)
    E = (F.T @ F - np.eye(3)) / 2
    e = np.linalg.eigvalsh(E)
    J = np.linalg.det(F)
    mu, lam = 0.001 / 2.8, 0.001 * 0.4 / (1.4 * 0.2)
    s = np.linalg.eigvalsh((mu * (F @ F.T - np.eye(3)) + lam * np.log(J) * np.eye(3)) / J)
    von = lambda l: np.sqrt(((l[0] - l[1]) ** 2 + (l[1] - l[2]) ** 2 + (l[2] - l[0]) ** 2) / 2)  # noqa: E731
    assert m.volumetric_strain == pytest.approx(J - 1, rel=1e-12)
    assert m.effective_strain == pytest.approx(von(e), rel=1e-12)
    assert m.max_shear_strain == pytest.approx(e[2] - e[0], rel=1e-12)
    assert m.effective_stress == pytest.approx(von(s), rel=1e-12)
    # semi-axes stretch with the body; the printed ratio is that of the principal inertias
    a = np.array([0.8, 1.1, 1.3])
    assert m.axes_ratio_change == pytest.approx(1.3 / 0.8 - 1, rel=1e-12)
    assert np.allclose(m.axes / m.axes[0], a / a[0])
    printed = np.sqrt((a[1] ** 2 + a[2] ** 2) / (a[0] ** 2 + a[1] ** 2))
    assert m.aspect_ratio_change == pytest.approx(printed - 1, rel=1e-12)
    assert np.allclose(m.centroid, [5, 1, 2])


def test_axes_of_a_ball_tend_to_its_radius(mesh, make):
    error = []
    for n in (4, 8):
        X, conn = mesh(n, radius=0.005)
        ds = make(X, [("hex8", "cell1", conn)], lambda X, t: X)
        error.append(abs(cell_metrics(ds).axes[0, 0] / 0.005 - 1).max().item())
    assert error[1] < 0.02 and error[1] < error[0] / 3


def test_rigid_rotation_changes_nothing(mesh, make):
    X, conn = mesh(4)
    Q = rotation(8)
    wavy = lambda X: X + 0.1 * np.sin(2 * X[:, [1, 2, 0]])  # noqa: E731
    p = lambda X, t: X[:, 0] ** 2 + X[:, 1]  # noqa: E731
    still = make(X, [("hex8", "cell1", conn)], lambda X, t: wavy(X) if t else X, pressure=p)
    turned = make(X, [("hex8", "cell1", conn)], lambda X, t: wavy(X) @ Q.T + 3 if t else X, pressure=p)
    a, b = (cell_metrics(d, model(["cell1"])).isel(time=1, cell=0) for d in (still, turned))
    for name in METRICS:
        assert abs(a[name]) > 1e-9
        assert a[name].item() == pytest.approx(b[name].item(), rel=1e-10), name


@pytest.mark.parametrize(("sides", "order"), [("both", 1.2), ("cell", 0.7)])
def test_uniform_radial_flux(coated_mesh, make, sides, order):
    """p = -c r^2/2k has q = c r: a rate of volume of 4 pi r^2 c r, closer with both sides of the surface."""
    k, c, r = 0.001, 0.7, 0.005
    exact = 4 * np.pi * r**2 * c * r
    error = []
    for n in (6, 12):
        X, cell, pcm = coated_mesh(n, r, 2)
        blocks = [("hex8", "cell1", cell), ("hex8", "pcm1", pcm)]
        ds = make(X, blocks, lambda X, t: X, pressure=lambda X, t: -c * (X**2).sum(axis=1) / (2 * k))
        m = cell_metrics(ds, model(["cell1", "pcm1"], k=k), sides=sides).isel(cell=0, time=1)
        error.append(abs(m.mass_exchange_rate.item() / exact - 1))
    assert np.log2(error[0] / error[1]) > order
    if sides == "both":
        assert error[1] < 0.02


def test_given_nodal_flux_is_integrated_exactly(mesh, make):
    X, conn = mesh(5, radius=0.005)
    ds = make(X, [("hex8", "cell1", conn)], lambda X, t: X)
    ds["nodal_fluid_flux"] = (("time", "element", "local", "xyz"), np.stack([0.7 * X[conn]] * 2))
    m = cell_metrics(ds).isel(cell=0, time=1)
    assert m.mass_exchange_rate.item() == pytest.approx(3 * 0.7 * m.volume.item(), rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_every_element_kind(one, make, kind):
    """One affine element: strain exact; the surface encloses the volume (divergence theorem)."""
    X, conn = one(kind)
    F = rotation() @ STRETCH
    ds = make(X, [(kind, "cell", conn)], lambda X, t: X @ (F if t else np.eye(3)).T)
    x = np.stack([X, X @ F.T])
    ds["nodal_fluid_flux"] = (("time", "element", "local", "xyz"), x[:, None])
    m = cell_metrics(ds, model(["cell"])).isel(cell=0)
    e = np.linalg.eigvalsh((F.T @ F - np.eye(3)) / 2)
    assert m.volumetric_strain[1] == pytest.approx(np.linalg.det(F) - 1, rel=1e-10)
    assert m.max_shear_strain[1] == pytest.approx(e[2] - e[0], rel=1e-10)
    assert np.allclose(m.mass_exchange_rate, 3 * m.volume, rtol=1e-10)
    f = element_fields(ds, "*", model(["cell"]))
    assert np.allclose(f.principal_strain[1, 0], e[::-1])
    mu, lam, J = 0.001 / 2.8, 0.001 * 0.4 / (1.4 * 0.2), np.linalg.det(STRETCH)
    s = (mu * (np.diag(STRETCH) ** 2 - 1) + lam * np.log(J)) / J
    assert np.allclose(f.principal_stress[1, 0], np.sort(s)[::-1], rtol=1e-10)
    assert "units" not in f.principal_stress.attrs and "material" in f.principal_stress.attrs["how"]
    # without the model, of the plotfile's element means
    mean = np.zeros((2, ds.sizes["element"], 6))
    mean[1, :, :3] = s
    ds["stress"] = (("time", "element", "voigt"), mean)
    bare = element_fields(ds, "*", names=["principal_stress"])
    assert np.allclose(bare.principal_stress[1, 0], np.sort(s)[::-1], rtol=1e-10)


@pytest.mark.parametrize("kind", KINDS)
def test_linear_pressure_gives_darcy_flux_in_the_deformed_configuration(one, make, kind):
    X, conn = one(kind)
    F, g = rotation() @ STRETCH, np.array([0.3, -0.2, 0.5])
    ds = make(X, [(kind, "cell", conn)], lambda X, t: X @ F.T, pressure=lambda X, t: X @ F.T @ g)
    f = element_fields(ds, "cell", model(["cell"], k=0.002), names=["fluid_flux"])
    assert np.allclose(f.fluid_flux, -0.002 * g, rtol=1e-9)


def test_a_field_costs_nothing_of_the_others(one, make, monkeypatch):
    X, conn = one("hex8")
    ds = make(X, [("hex8", "cell", conn)], lambda X, t: X @ STRETCH.T, pressure=lambda X, t: X[:, 0])
    for module, name in ((Sources, "effective_stress"), (tensors, "effective"), (tensors, "max_difference")):
        monkeypatch.setattr(module, name, lambda *_, n=name: pytest.fail(f"{n} was not asked for"))
    assert list(element_fields(ds, "*", model(["cell"]), ["fluid_flux"])) == ["fluid_flux"]
    assert list(element_fields(ds, "*", model(["cell"]), ["volume"])) == ["volume"]


def test_cells_in_one_part_are_told_apart(mesh, make):
    A, conn = mesh(3)
    X = np.vstack([A, A + 5])
    ds = make(X, [("hex8", "cells", np.vstack([conn, conn + len(A)]))], lambda X, t: X * (1 + 0.1 * t))
    m = cell_metrics(ds)
    assert list(m.cell.values) == ["cell1", "cell2"]
    assert np.allclose(m.volumetric_strain[:, 1], 1.1**3 - 1)
    whole = cell_metrics(ds, cells={"both": "cells"})
    assert whole.sizes["cell"] == 2  # one name, two pieces
    labels = np.repeat([0, 4], len(conn))
    assert list(cell_metrics(ds, cells=labels).cell.values) == ["cell4"]


def test_without_a_model_the_plotfile_speaks_and_says_so(mesh, make):
    X, conn = mesh(3)
    ds = make(X, [("hex8", "cell1", conn)], lambda X, t: X)
    bare = cell_metrics(ds)
    assert "effective_stress" not in bare and "mass_exchange_rate" not in bare
    assert "effective_stress: missing" in bare.attrs["missing"]
    s = np.zeros((2, len(conn), 6))
    s[..., 3] = 2.0
    ds = ds.assign(
        stress=(("time", "element", "voigt"), s),
        fluid_flux=(("time", "element", "xyz"), np.ones((2, len(conn), 3))),
    )
    m = cell_metrics(ds)
    assert np.allclose(m.effective_stress, np.sqrt(3) * 2)
    assert "element mean" in m.effective_stress.attrs["how"]
    assert np.allclose(m.mass_exchange_rate, 0, atol=1e-4)  # a uniform flux leaves as it enters


def test_clear_refusals(mesh, make):
    X, conn = mesh(2)
    ds = make(X, [("hex8", "ecm", conn)], lambda X, t: X)
    with pytest.raises(InputError, match="ecm"):
        cell_metrics(ds)
    with pytest.raises(InputError, match="nothing"):
        cell_metrics(ds.drop_vars("displacement"), cells="ecm")
    with pytest.raises(InputError, match="overlap"):
        cell_metrics(ds, cells={"a": "ecm", "b": [0, 1]})


def test_tensor_invariants_agree_with_eigenvalues():
    rng = np.random.default_rng(0)
    s = rng.normal(size=(6, 500))
    s[:, 0] = 0
    s[:3, 1] = 4.0
    s[3:, 1] = 0
    full = np.empty((500, 3, 3))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))):
        full[:, i, j] = full[:, j, i] = s[k]
    e = np.linalg.eigvalsh(full)[:, ::-1].T
    assert np.allclose(principal(s), e, atol=1e-7)
    assert np.allclose(max_difference(s), e[0] - e[2], atol=1e-7)
    v = np.sqrt(((e[0] - e[1]) ** 2 + (e[1] - e[2]) ** 2 + (e[2] - e[0]) ** 2) / 2)
    assert np.allclose(effective(s), v)

"""A cube whose every node is moved by one deformation gradient: all measures are known in closed form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import logm, sqrtm

import febkit
from febkit.results.xplt.reader import PlotFile

CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
F = np.array([[1.10, 0.20, -0.05], [0.03, 0.90, 0.15], [0.10, -0.08, 1.05]])
E, NU, RHO = 3.0, 0.3, 2.0
VOIGT = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]
I = np.eye(3)


def deck(variables: list[str], log: str = "") -> str:
    nodes = "".join(f'<node id="{k + 1}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(CUBE))
    sets = "".join(f'<NodeSet name="n{k + 1}">{k + 1}</NodeSet>' for k in range(8))
    bc = ""
    for k, X in enumerate(CUBE):
        u = (F - I) @ X
        for d, v in zip("xyz", u, strict=True):
            bc += f'<bc node_set="n{k + 1}" type="prescribed displacement"><dof>{d}</dof>'
            bc += f'<value lc="1">{float(v)!r}</value><relative>0</relative></bc>'
    asked = "".join(f'<var type="{v}"/>' for v in variables)
    return f"""<?xml version="1.0"?>
<febio_spec version="4.0"><Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>2</time_steps><step_size>0.5</step_size><solver type="solid"/></Control>
<Material><material id="1" name="m" type="solid mixture"><density>{RHO}</density>
<mat_axis type="vector"><a>1,1,0</a><d>0,1,0</d></mat_axis>
<solid type="neo-Hookean"><E>{E}</E><v>{NU}</v></solid>
<solid type="fiber-exp-pow"><ksi>1</ksi><alpha>0.1</alpha><beta>2.5</beta><fiber type="vector">1,0,1</fiber></solid>
</material></Material>
<Mesh><Nodes>{nodes}</Nodes><Elements type="hex8" name="cube"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>{sets}
<Surface name="all"><quad4 id="1">1,4,3,2</quad4><quad4 id="2">5,6,7,8</quad4><quad4 id="3">1,2,6,5</quad4>
<quad4 id="4">2,3,7,6</quad4><quad4 id="5">3,4,8,7</quad4><quad4 id="6">4,1,5,8</quad4></Surface></Mesh>
<MeshDomains><SolidDomain name="cube" mat="m"/></MeshDomains><Boundary>{bc}</Boundary>
<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>
<Output><plotfile type="febio">{asked}</plotfile><logfile>{log}</logfile></Output></febio_spec>"""


def solve(folder: Path, variables: list[str], log: str = "") -> dict[str, np.ndarray]:
    """The last values of each variable of the first region."""
    path = folder / "cube.feb"
    path.write_text(deck(variables, log))
    said: list[str] = []
    result = febkit.solve(path, plotfile=folder / "cube.xplt", logfile=folder / "cube.log", warn=said.append)
    assert result.converged and not said, said
    with PlotFile(folder / "cube.xplt") as f:
        last = len(f.states) - 1
        return {v.name: next(np.array(a) for _, a in f.regions(k, last)) for k, v in enumerate(f.variables)}


def stress() -> np.ndarray:
    """Cauchy stress of the neo-Hookean solid."""
    mu, lam = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
    J, b = np.linalg.det(F), F @ F.T
    return (mu * (b - I) + lam * np.log(J) * I) / J


def tensors() -> dict[str, np.ndarray]:
    C, B, J = F.T @ F, F @ F.T, np.linalg.det(F)
    old = I + 0.5 * (F - I)
    L = (F - old) @ np.linalg.inv(F) / 0.5
    return {
        "Lagrange strain": 0.5 * (C - I), "infinitesimal strain": 0.5 * (F + F.T) - I,
        "Almansi strain": 0.5 * (I - np.linalg.inv(B)), "right Cauchy-Green": C, "left Cauchy-Green": B,
        "right stretch": sqrtm(C), "left stretch": sqrtm(B),
        "right Hencky": 0.5 * logm(C), "left Hencky": 0.5 * logm(B),
        "rate of deformation": 0.5 * (L + L.T), "mixture stress['solid[0]']": stress(), "relative volume": J,
    }  # fmt: skip


def test_measures_of_strain_stretch_and_rate(tmp_path: Path) -> None:
    known = tensors()
    got = solve(tmp_path, list(known))
    for name, T in known.items():
        want = [T] if np.ndim(T) == 0 else [T[i, j] for i, j in VOIGT]
        np.testing.assert_allclose(got[name].ravel(), np.real(want), rtol=2e-6, atol=1e-7, err_msg=name)


def test_stresses_belong_to_each_other(tmp_path: Path) -> None:
    got = solve(tmp_path, ["stress", "PK1 stress", "PK2 stress", "s norm", "SPR stress", "nodal stress",
                           "mixture stress['solid[0]']=matrix", "mixture stress['solid[1]']=fibers"])  # fmt: skip

    def full(v: np.ndarray) -> np.ndarray:
        return v.ravel()[[0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(3, 3)

    s, J, Fi = full(got["stress"]), np.linalg.det(F), np.linalg.inv(F)
    np.testing.assert_allclose(full(got["matrix"]) + full(got["fibers"]), s, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(got["PK1 stress"].reshape(3, 3), J * s @ Fi.T, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(full(got["PK2 stress"]), J * Fi @ s @ Fi.T, rtol=1e-5, atol=1e-6)
    assert got["s norm"].item() == pytest.approx(np.linalg.norm(s), rel=1e-5)
    np.testing.assert_allclose(got["nodal stress"].reshape(8, 6), np.tile(got["stress"].reshape(1, 6), (8, 1)), 1e-5)
    assert not got["SPR stress"].any()  # FEBio wants more than eight points for the seven terms of a hexahedron


def test_fibers_and_axes_follow_the_gradient(tmp_path: Path) -> None:
    got = solve(tmp_path, ["material axes", "fiber vector['solid[1]']=a", "fiber stretch['solid[1]']=l"])
    first = np.array([1, 1, 0]) / np.sqrt(2)
    Q = np.stack([first, np.cross([0, 0, 1], first), [0, 0, 1]], axis=1)
    np.testing.assert_allclose(got["material axes"].reshape(3, 3), Q, atol=1e-6)
    a = F @ Q @ np.array([1, 0, 1]) / np.sqrt(2)
    np.testing.assert_allclose(got["a"].ravel(), a / np.linalg.norm(a), rtol=1e-6, atol=1e-7)
    assert got["l"].item() == pytest.approx(np.linalg.norm(a), rel=1e-6)


def test_surfaces_enclose_what_is_inside(tmp_path: Path) -> None:
    got = solve(tmp_path, ["enclosed volume", "enclosed volume change", "surface area", "facet area",
                           "surface reaction force", "density", "element strain energy", "total energy"])  # fmt: skip
    J = np.linalg.det(F)
    assert got["enclosed volume"].item() == pytest.approx(J, rel=1e-6)
    assert got["enclosed volume change"].item() == pytest.approx(J - 1, rel=1e-5)
    cofactor = J * np.linalg.inv(F).T
    sides = [np.linalg.norm(cofactor @ n) for n in (-I[2], I[2], -I[1], I[0], I[1], -I[0])]
    np.testing.assert_allclose(got["facet area"].ravel(), sides, rtol=1e-6)
    assert got["surface area"].item() == pytest.approx(sum(sides), rel=1e-6)
    np.testing.assert_allclose(got["surface reaction force"].ravel(), 0, atol=1e-6)
    assert got["density"].item() == pytest.approx(RHO / J, rel=1e-6)
    assert got["total energy"].item() == pytest.approx(got["element strain energy"].item(), rel=1e-6)


def test_data_records_say_the_same(tmp_path: Path) -> None:
    log = ('<element_data data="Ux;Fxy;nonsense;J;V;E1;E2;E3;=sqrt(sx^2)+2*J" file="e.csv" delim=","/>'
           '<domain_data data="volume;avg(\'J\');integrate(\'J\')" file="d.csv" delim=","/>'
           '<surface_data surface="all" data="volume;volume change" file="s.csv" delim=","/>'
           '<face_data surface="all" data="facet area" file="f.csv" delim="," comments="off" format="%i: %g"/>')
    path = tmp_path / "cube.feb"
    path.write_text(deck(["stress"], log))
    said: list[str] = []
    febkit.solve(path, logfile=tmp_path / "cube.log", warn=said.append)
    assert said == ['element_data "nonsense" is not computed by febkit; it is left out']

    def last(name: str) -> list[float]:
        lines = (tmp_path / name).read_text().splitlines()
        return [float(x) for x in lines[-1].split(",")[1:]]

    J, C = np.linalg.det(F), F.T @ F
    Ux, Fxy, j, V, *principal, formula = last("e.csv")
    assert (Ux, Fxy) == (pytest.approx(sqrtm(C)[0, 0]), pytest.approx(F[0, 1]))
    assert (j, V) == (pytest.approx(J), pytest.approx(J))
    np.testing.assert_allclose(principal, np.linalg.eigvalsh(0.5 * (C - I))[::-1], rtol=1e-9)
    assert formula > 2 * J
    np.testing.assert_allclose(last("d.csv"), [J, J, J], rtol=1e-9)
    np.testing.assert_allclose(last("s.csv"), [J, J - 1], rtol=1e-9)
    facets = (tmp_path / "f.csv").read_text().splitlines()
    assert facets[0] == "1: 1" and len(facets) == 6 * 3  # the state at rest and two steps

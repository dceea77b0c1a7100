"""Meshes that adaptors refine: where FEBio 4.11 fails, what a failed step gives back, what is told, what is refused."""

from __future__ import annotations

import re
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit import results
from febkit.lower import lower, unsupported
from febkit.model import InputError
from febkit.solver.group import NegativeJacobian
from febkit.solver.newton import Newton, NotConverged
from febkit.solver.run import Run
from helpers.refined import ERROR, EVERY, FLUID, PRESSURE, PULL, VISCOUS, adaptor, chosen, deck

ONCE = adaptor("hex_refine", EVERY, max_iters=1, max_elements=9)


def solved(folder: Path, text: str, name: str = "m") -> Any:
    (folder / f"{name}.feb").write_text(text)
    result = febkit.solve(folder / f"{name}.feb", folder / f"{name}.xplt", folder / f"{name}.log")
    assert result.converged, result.reason
    return result


def at_nodes(path: Path) -> dict[tuple[float, ...], np.ndarray]:
    """Displacements at the end, by place."""
    ds = results.open_all(path)[-1]
    return {tuple(np.round(x, 5)): v for x, v in zip(ds.X.values.tolist(), ds.displacement.values[-1])}


@pytest.mark.parametrize(("kind", "cut", "parts"), [
    ("hex8", ONCE, 1), ("hex8", ONCE, 2), ("tet4", adaptor("tet_refine", max_elements=49), 2),
])  # fmt: skip
def test_a_loaded_bar_cut_once_is_one_meshed_so(tmp_path: Path, kind: str, cut: str, parts: int) -> None:
    """Pressure on facets that are cut, and several parts of tetrahedra, stop FEBio; loads of nodes grow with these."""
    loads = PRESSURE.replace("0.02", "0.03")
    solved(tmp_path, deck(cut, (2, 2, 2), kind, parts=parts, loads=loads))
    fine = results.open_all(tmp_path / "m.xplt")[-1]
    assert fine.sizes["element"] == 8 * (8 if kind == "hex8" else 48)
    mesh = febkit.read(tmp_path / "m.feb")
    problem = lower(mesh)
    first = Run(problem)
    first.solve()
    last = first.problem  # the fine mesh, solved from rest and without an adaptor
    last.common.adaptors = []
    again = Run(last)
    assert again.solve().converged and len(again.state.X) > len(problem.X)
    np.testing.assert_allclose(first.state.u, again.state.u, atol=1e-7)


def test_parts_are_cut_where_another_is_not(tmp_path: Path) -> None:
    """FEBio looks at the wrong elements once a part has none to cut."""
    two, one = (deck(adaptor("hex_refine", chosen("9,12"), max_iters=1), parts=k) for k in (2, 1))
    solved(tmp_path, two.replace("<E>3", "<E>1").replace("<v>0.2", "<v>0.3"), "two")
    solved(tmp_path, one, "one")
    a, b = (results.open_all(tmp_path / f"{n}.xplt")[1] for n in ("two", "one"))
    assert a.sizes["element"] == b.sizes["element"] == 30
    np.testing.assert_allclose(a.displacement.values, b.displacement.values, atol=1e-6)


def test_fluid_at_nodes_that_hang_goes_on(tmp_path: Path) -> None:
    """A column squeezed through its top, cut at the top alone: as moved as one that is cut throughout. FEBio loses the
    fluid at nodes that hang, and is off by 13 %."""
    column: dict[str, Any] = {**FLUID, "n": (1, 1, 8), "steps": 4}
    sides = '<bc node_set="all" type="zero displacement"><x_dof>1</x_dof><y_dof>1</y_dof></bc>'
    u = {}
    for name, criterion in {"whole": EVERY, "top": '<criterion type="math"><math>Z-1.5</math></criterion>'}.items():
        text = deck(adaptor("hex_refine", criterion, max_iters=1, max_elements=9), **column)
        text = text.replace("@surface:end", "@surface:top").replace('<value lc="1">0.5', '<value lc="1">-0.2')
        text = text.replace("<Boundary>", "<Boundary>" + sides).replace("<perm>0.1", "<perm>0.3")
        text = text.replace('node_set="held" type="zero displacement">\n<x_dof>1</x_dof>\n<y_dof>1</y_dof>',
                            'node_set="base" type="zero displacement">')  # fmt: skip
        text = text.replace("</Mesh>", '<NodeSet name="base">1,10,19,28</NodeSet></Mesh>')
        with nullcontext() if name == "whole" else pytest.warns(UserWarning, match="FEBio 4.11 loses it"):
            solved(tmp_path, text, name)
        u[name] = at_nodes(tmp_path / f"{name}.xplt")
    both = [k for k in u["top"] if k in u["whole"]]
    assert len(both) >= 36 and len(u["top"]) < len(u["whole"])
    a, b = (np.array([u[n][k] for k in both]) for n in ("top", "whole"))
    assert np.abs(a - b).max() < 0.02 * np.abs(b).max()


def test_a_step_that_fails_gives_the_mesh_back(tmp_path: Path) -> None:
    sized = "<time_stepper><dtmax>0.25</dtmax></time_stepper>"
    text = deck(adaptor("hex_refine", chosen("1"), max_iters=1), stepper=sized)
    (tmp_path / "m.feb").write_text(text)
    step, failed = Newton.step, []

    def once(self: Any, how: Any = None) -> Any:
        if len(self.system.state.X) > 45 and not failed:
            failed.append(self.system.state.time)
            raise NotConverged("on purpose")
        return step(self, how)

    Newton.step = once  # type: ignore[method-assign]
    try:
        result = febkit.solve(tmp_path / "m.feb", tmp_path / "m.xplt")
    finally:
        Newton.step = step  # type: ignore[method-assign]
    assert result.converged and failed == [0.25] and result.totals.retries == 1
    every = results.open_all(tmp_path / "m.xplt")
    assert [ds.sizes["element"] for ds in every] == [16, *(16 + 7 * k for k in range(1, len(every)))]
    assert every[1].time.values[0] == pytest.approx(0.25 * 5 / 6)


def test_no_second_solve_where_the_file_says_so(tmp_path: Path) -> None:
    text = deck(adaptor("hex_refine", chosen("1"), max_iters=1))
    both = [
        solved(tmp_path, text.replace("<solver", f"<adaptor_re_solve>{k}</adaptor_re_solve><solver", 1), f"m{k}")
        for k in (1, 0)
    ]
    assert both[0].totals.iterations > both[1].totals.iterations
    last = [results.open_all(tmp_path / f"m{k}.xplt")[-1] for k in (1, 0)]
    assert last[0].sizes["element"] == last[1].sizes["element"] == 30
    np.testing.assert_allclose(*(ds.displacement.values[-1] for ds in last), atol=0.02)


def test_what_is_told(tmp_path: Path) -> None:
    """Data files go on about the items that they began with; the log counts; datasets come mesh by mesh."""
    text = deck(adaptor("hex_refine", chosen("16"), max_iters=1)).replace(
        "<Output>", '<Output><logfile><node_data data="ux" file="u.csv"/>'
        '<element_data data="sx" file="s.csv">2,16</element_data></logfile>')  # fmt: skip
    solved(tmp_path, text)
    u = results.read_data(tmp_path / "u.csv")
    last = results.open_all(tmp_path / "m.xplt")[-1]
    rows = [line.split() for line in (tmp_path / "u.csv").read_text().splitlines() if line[:1] != "*"]
    assert len(rows) == 3 * 45 and u is not None
    np.testing.assert_allclose([float(r[1]) for r in rows[-45:]], last.displacement.values[-1, :45, 0], atol=1e-6)
    s = [line.split() for line in (tmp_path / "s.csv").read_text().splitlines() if line[:1] != "*"]
    assert [r[0] for r in s] == ["2", "16"] * 3
    at = last.element_id.values.tolist().index(16)
    assert float(s[-1][1]) == pytest.approx(float(last.stress.values[-1, at, 0]), rel=1e-5)
    assert (tmp_path / "m.log").read_text().count("Number of elements : 23") == 1
    result = febkit.read(tmp_path / "m.feb").solve()
    assert [ds.sizes["element"] for ds in result.datasets] == [16, 23]
    with pytest.raises(InputError, match=r"the mesh changed during the run: take \.datasets"):
        _ = result.dataset


@pytest.mark.parametrize(("change", "says"), [
    (("<max_iters>1", "<map_data>1</map_data><max_iters>1"), "<map_data>1</map_data>"),
    (('type="neo-Hookean"', 'type="rigid body"'), 'a rigid body ("m1")'),
    (("<Boundary>", '<MeshData><NodeData name="m" node_set="held" type="math"><math>X</math></NodeData></MeshData>'
      "<Boundary>"), 'the map "m"'),
    (("<Boundary>", '<Constraints><constraint type="volume" surface="top"/></Constraints><Boundary>'),
     '<constraint type="volume">'),
    (("<LoadData>", '<Loads><surface_load surface="top" type="ideal gas pressure"><P0>1</P0></surface_load></Loads>'
      "<LoadData>"), 'type="ideal gas pressure"'),
    (("</MeshAdaptor>", adaptor("erosion", ERROR) + "</MeshAdaptor>"), '<mesh_adaptor type="erosion">'),
    (('name="P1" mat="m1"/>', 'name="P1" mat="m1" type="ut4-solid"/>'), "ut4"),
    (('type="solid"><dtol>', 'type="explicit-solid"><dtol>'), "explicit-solid"),
    (("<rtol>0</rtol>", "<rtol>0</rtol><arc_length>1</arc_length>"), "<arc_length>"),
])  # fmt: skip
def test_what_stays_on_its_mesh_is_refused(tmp_path: Path, change: tuple[str, str], says: str) -> None:
    kind = "tet4" if "ut4" in says else "hex8"
    cut = adaptor("tet_refine", max_iters=1) if kind == "tet4" else adaptor("hex_refine", chosen("1"), max_iters=1)
    text = deck(cut, (2, 1, 1), kind).replace(">\n<", "><")
    assert change[0] in text
    (tmp_path / "m.feb").write_text(text.replace(*change).replace("><", ">\n<"))
    found = [str(e) for e in unsupported(febkit.read(tmp_path / "m.feb"))]
    assert any(says in e and "m.feb:" in e for e in found), found


@pytest.mark.parametrize(("text", "says"), [
    (deck(adaptor("tet_refine"), (2, 1, 1), "tet4"), "would go on for ever: give <max_iters> or <max_elements>"),
    (deck(adaptor("test_refine", max_elements=5), (2, 1, 1), "tet4"), "would go on for ever: give <max_iters>"),
    (deck(adaptor("tet_refine", max_iters=1)), 'takes tet4 elements; part "P1" has hex8'),
    (deck(adaptor("hex_refine", max_iters=1)), "lacks <criterion>"),
    (deck(adaptor("hex_refine", chosen("1"), rounds=1)), "<rounds> of <mesh_adaptor"),
    (deck(adaptor("hex_refine", chosen("1")).replace('"hex_refine"', '"hex_refine" elem_set="none"')), "none"),
])  # fmt: skip
def test_what_cannot_be_is_said(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "m.feb").write_text(text)
    with pytest.raises(InputError, match=says.replace("<", ".?<")):
        lower(febkit.read(tmp_path / "m.feb"))


def test_elements_on_their_side_are_not_cut_in_the_plane(tmp_path: Path) -> None:
    text = deck(adaptor("hex_refine2d", chosen("1"), max_iters=1), (2, 1, 1))
    first = re.search(r'<elem id="1">([\d,]+)<', text)
    assert first is not None
    n = first[1].split(",")
    turned = text.replace(first[1], ",".join(n[k] for k in (1, 5, 6, 2, 0, 4, 7, 3)))
    (tmp_path / "m.feb").write_text(turned)
    result = febkit.solve(tmp_path / "m.feb")
    assert not result.converged and "planes of constant Z" in result.reason


def test_laws_and_loads_are_those_of_the_file_again(tmp_path: Path) -> None:
    """Conditions by formulas and curves hold on the new mesh; sets of surfaces grow by what lies among them."""
    text = deck(adaptor("hex_refine", EVERY, max_iters=1, max_elements=17), (2, 2, 2), material=VISCOUS, loads=PULL)
    result = solved(tmp_path, text.replace('<value lc="1">0.5', '<value type="math">0.1*t*Y'))
    X, u = result.state.X, result.state.u
    end = np.abs(X[:, 0] - 0.03 * X[:, 1] ** 2 - 4.0) < 0.02
    assert end.sum() == 25
    np.testing.assert_allclose(u[end, 2], 0.1 * 0.5 * X[end, 1], atol=1e-12)


def test_a_second_solve_that_always_fails_ends_the_run(tmp_path: Path) -> None:
    """In steps of one size too, where guarded steps are tried once elements turn inside out."""
    (tmp_path / "m.feb").write_text(deck(adaptor("hex_refine", chosen("1"), max_iters=1)))
    step = Newton.step

    def never(self: Any, how: Any = None) -> Any:
        if len(self.system.state.X) > 45:
            raise NegativeJacobian(1, "P1")
        return step(self, how)

    Newton.step = never  # type: ignore[method-assign]
    try:
        result = febkit.solve(tmp_path / "m.feb")
    finally:
        Newton.step = step  # type: ignore[method-assign]
    assert not result.converged and "turned inside out" in result.reason and result.totals.retries < 20
    assert len(result.state.X) == 45

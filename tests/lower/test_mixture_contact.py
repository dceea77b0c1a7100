"""Contact between mixtures with solutes, against the same body in one piece."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from helpers.mixture_deck import HELD, R, T, deck, initial, material, prescribed, refused, solute, solve

BATH = prescribed("concentration", "start", 1.0, "c3") + prescribed("fluid pressure", "start", 0.0)
DIFFUSING = material("multiphasic", solute("Glc", 0.3), E=10.0)


def halves(n: int) -> str:
    """A rod of unit length in two parts of n hex8 each along z, whose end faces meet without sharing nodes."""
    nodes, elements, sets = [], [], {"start": [1, 2, 3, 4]}
    for part in (0, 1):
        first = len(nodes)
        for k in range(n + 1):
            nodes += [(x, y, 0.5 * part + 0.5 * k / n) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        elements.append([[first + 4 * k + i for i in range(1, 9)] for k in range(n)])
    m = 4 * (n + 1)
    sets |= {"all": list(range(1, 2 * m + 1)), "end": list(range(2 * m - 3, 2 * m + 1))}
    text = "".join(f'<node id="{i}">{x},{y},{z}</node>' for i, (x, y, z) in enumerate(nodes, 1))
    out, number = f'<Nodes name="n">{text}</Nodes>', 1
    for name, part in zip("ab", elements):
        out += f'<Elements type="hex8" name="{name}">'
        for e in part:
            out += f'<elem id="{number}">{",".join(map(str, e))}</elem>'
            number += 1
        out += "</Elements>"
    out += "".join(f'<NodeSet name="{k}">{",".join(map(str, v))}</NodeSet>' for k, v in sets.items())
    upper, lower = ",".join(map(str, range(m - 3, m + 1))), ",".join(map(str, (m + 4, m + 3, m + 2, m + 1)))
    out += f'<Surface name="upper"><quad4 id="1">{upper}</quad4></Surface>'
    out += f'<Surface name="lower"><quad4 id="1">{lower}</quad4></Surface>'
    return out + "<SurfacePair name='pair'><primary>upper</primary><secondary>lower</secondary></SurfacePair>"


TWO = '<SolidDomain name="a" mat="m"/><SolidDomain name="b" mat="m"/>'


def contact(kind: str, more: str = "") -> str:
    return f"""<Contact><contact type="{kind}" surface_pair="pair"><laugon>PENALTY</laugon>
<auto_penalty>1</auto_penalty><penalty>100</penalty><pressure_penalty>1e4</pressure_penalty><concentration_penalty>1e4</concentration_penalty>
<two_pass>1</two_pass><knmult>1</knmult><search_tol>0.01</search_tol><search_radius>1</search_radius>
<symmetric_stiffness>0</symmetric_stiffness>{more}</contact></Contact>"""


def squeezed(by: float) -> str:
    """Nothing moves sideways; the far end is pushed in."""
    sides = HELD.replace("<z_dof>1</z_dof>", "<z_dof>0</z_dof>")
    held = '<bc type="zero displacement" node_set="start"><x_dof>0</x_dof><y_dof>0</y_dof><z_dof>1</z_dof></bc>'
    return sides + held + prescribed("displacement", "end", -by, "z")


@pytest.mark.parametrize("kind", ["tied-multiphasic", "sliding-multiphasic", "sliding-biphasic-solute"])
def test_two_halves_are_one_body(kind: str, tmp_path: Path) -> None:
    """A solute diffuses and fluid leaves through the face where two squeezed halves meet as if there were none."""
    boundary, start = squeezed(0.05) + BATH, initial("c3", 0.2)
    module = "solute" if "solute" in kind else "multiphasic"
    made = DIFFUSING.replace('type="multiphasic"', 'type="biphasic-solute"') if module == "solute" else DIFFUSING
    common = {"steps": (8, 0.05), "module": module}
    whole = solve(deck(made, boundary, start, n=4, **common), tmp_path)
    split = solve(
        deck(made, boundary, start, mesh=halves(2), domains=TWO, more=contact(kind), **common), tmp_path
    )  # fmt: skip
    a, b = (ds["effective_solute_concentration"].isel(time=-1).sel(solute="Glc").values for ds in (whole, split))
    assert a[-1] < 0.9 and a[8] > 0.25
    assert np.allclose(b[:12], a[:12], rtol=1e-3) and np.allclose(b[12:], a[8:], rtol=1e-3)
    p, q = (ds["effective_fluid_pressure"].isel(time=-1).values for ds in (whole, split))
    scale = np.abs(p).max()
    assert np.abs(q[:12] - p[:12]).max() < 2e-3 * scale and np.abs(q[12:] - p[8:]).max() < 2e-3 * scale


def test_faces_that_part_take_what_surrounds_them(tmp_path: Path) -> None:
    boundary = squeezed(-0.05) + BATH
    ambient = f"<ambient_pressure>{-R * T * 0.7!r}</ambient_pressure>"
    ambient += '<ambient_concentration sol="Glc">0.7</ambient_concentration>'
    text = deck(
        DIFFUSING, boundary, initial("c3", 0.2), mesh=halves(2), domains=TWO, steps=(4, 0.05),
        more=contact("sliding-multiphasic", ambient),
    )  # fmt: skip
    last = solve(text, tmp_path).isel(time=-1)
    faces = np.r_[8:12, 12:16]
    assert last["effective_solute_concentration"].sel(solute="Glc").values[faces] == pytest.approx(0.7)
    assert last["effective_fluid_pressure"].values[faces] == pytest.approx(-R * T * 0.7)


def test_friction_between_biphasic_solutes_is_refused(tmp_path: Path) -> None:
    more = contact("sliding-biphasic-solute", "<fric_coeff>0.1</fric_coeff>")
    text = deck(DIFFUSING, squeezed(0.05) + BATH, mesh=halves(2), domains=TWO, more=more)
    assert "fric_coeff" in refused(text, tmp_path)


@pytest.mark.parametrize(
    ("kind", "more", "said"),
    [
        ("sliding-biphasic", "", "sliding-multiphasic"),
        ("tied-biphasic", "", "tied-multiphasic"),
        ("sliding-biphasic-solute", "", "sliding-multiphasic"),
        ("tied-multiphasic", "<update_penalty>1</update_penalty>", "<update_penalty>"),
        ("tied-multiphasic", "<ambient_pressure>1</ambient_pressure>", "<ambient_pressure>"),
    ],
)
def test_what_fluid_cannot_pass_is_refused(kind: str, more: str, said: str, tmp_path: Path) -> None:
    """FEBio would take materials with solutes for impermeable in biphasic contact."""
    given = contact(kind, more)
    if kind.endswith("biphasic"):
        given = given.replace("<concentration_penalty>1e4</concentration_penalty>", "")
    text = deck(DIFFUSING, squeezed(0.05) + BATH, mesh=halves(2), domains=TWO, more=given)
    assert said in refused(text, tmp_path)


def test_a_bath_may_change_with_time(tmp_path: Path) -> None:
    boundary = squeezed(-0.05) + BATH
    ambient = '<ambient_concentration sol="Glc" lc="1">0.8</ambient_concentration>'
    curve = """<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points>
<pt>0,0.25</pt><pt>0.2,1</pt></points></load_controller></LoadData>"""
    text = deck(
        DIFFUSING, boundary, initial("c3", 0.2), mesh=halves(2), domains=TWO, steps=(4, 0.05),
        more=contact("sliding-multiphasic", ambient) + curve,
    )  # fmt: skip
    c = solve(text, tmp_path)["effective_solute_concentration"].sel(solute="Glc").values[:, 8:16]
    assert c[-1] == pytest.approx(0.8)
    assert c[-3] == pytest.approx(0.5)


def test_differences_across_a_contact_in_the_plotfile(tmp_path: Path) -> None:
    """What passes a tie, at rest, is its penalty times the difference; the fluid's force is pressure times area."""
    ends = BATH + prescribed("concentration", "end", 0.4, "c3") + prescribed("fluid pressure", "end", 0.3)
    weak = contact("tied-multiphasic").replace("two_pass>1", "two_pass>0").replace("auto_penalty>1", "auto_penalty>0")
    text = deck(
        DIFFUSING, HELD + ends, initial("c3", 0.7), mesh=halves(2), domains=TWO, more=weak.replace("1e4", "2"),
        analysis="STEADY-STATE",
    )  # fmt: skip
    names = ("pressure gap", "concentration gap", "fluid force", "fluid flux")
    last = solve(text.replace("</plotfile>", "".join(f'<var type="{n}"/>' for n in names) + "</plotfile>"), tmp_path)
    last = last.isel(time=-1)
    gap, step = last["pressure_gap"].values.ravel()[0], last["concentration_gap"].sel(solute="Glc").values.ravel()[0]
    w, j = last["fluid_flux"].values[:, 2], last["solute_flux"].sel(solute="Glc").values[:, 2]
    assert gap == pytest.approx(w[1] / 2, rel=1e-3) and step == pytest.approx(j[1] / 2, rel=1e-2)
    assert (last["concentration_gap"].sel(solute="Na").values == 0).all()
    p = last["effective_fluid_pressure"].values
    np.testing.assert_allclose(last["fluid_force"].values.reshape(2, 3)[:, 2], [p[8], -p[12]], rtol=1e-6)
    assert p[8] - p[12] == pytest.approx(gap, rel=1e-5)

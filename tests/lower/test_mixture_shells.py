"""Shells of mixtures: fluid pressure and concentrations on both faces, through the installed command."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from helpers.mixture_deck import R, T, deck, material, refused, rod, solute, solve

H, LENGTH, N, K = 0.1, 1.0, 4, 0.05  # thickness of the shell, the rod it closes, the rod's elements, permeability
BATH = -R * T * 200.0  # effective pressure of a bath of 100 of each ion
BIPHASIC = """<material id="1" name="m" type="biphasic"><phi0>0.2</phi0><solid type="neo-Hookean"><E>1.0</E><v>0.2</v>
</solid><permeability type="perm-Holmes-Mow"><perm>0.05</perm><M>1</M><alpha>2</alpha></permeability></material>"""
MADE_OF = {
    "biphasic": BIPHASIC,
    "solute": material("biphasic-solute", solute("Glc", 0.3)),
    "multiphasic": material(
        "multiphasic", solute("Na", 0.4) + solute("Cl", 0.7), "<fixed_charge_density>-30</fixed_charge_density>"
    ),
}
RAMP = """<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><pt>0,0</pt>
<pt>0.3,1</pt></points></load_controller></LoadData>"""
WRITTEN = "".join(
    f'<var type="{v}"/>'
    for v in (
        "effective shell fluid pressure", "effective shell solute concentration['Glc']", "fluid flux",
        "shell displacement", "nodal shell director", "shell director", "shell thickness",
    )
)  # fmt: skip


def bc(kind: str, where: str, value: str = "", dof: str = "") -> str:
    named = f"<dof>{dof}</dof>" if dof else ""
    return f'<bc type="{kind}" node_set="{where}">{named}{value and f"<value>{value}</value>"}</bc>'


def ic(kind: str, value: float, dof: str = "") -> str:
    named = f"<dof>{dof}</dof>" if dof else ""
    return f'<ic type="initial {kind}" node_set="all">{named}<value>{value}</value></ic>'


def held(where: str, s: str = "") -> str:
    dofs = "".join(f"<{s}{a}_dof>1</{s}{a}_dof>" for a in "xyz")
    return f'<bc type="zero {"shell " if s else ""}displacement" node_set="{where}">{dofs}</bc>'


def shell(name: str) -> str:
    return f'<ShellDomain name="S" mat="{name}"><shell_thickness>{H}</shell_thickness></ShellDomain>'


def finished(text: str, module: str) -> str:
    """Without what a biphasic solver does not know, and with what shells have to show."""
    text = text.replace("<ctol>1e-8</ctol>", "") if module == "biphasic" else text
    return text.replace("</plotfile>", WRITTEN + "</plotfile>").replace("1e-8<", "1e-9<")


# ---- shells on solids ----------------------------------------------------------------------------------------------
PRESSED = (
    held("start") + '<bc type="prescribed displacement" node_set="end"><dof>z</dof><value lc="1">-0.1</value></bc>'
)
DRIVEN = {  # conditions on the face, initial values, and those of the shell's back
    "biphasic": (bc("zero fluid pressure", "end"), "", ""),
    "solute": (bc("zero fluid pressure", "end") + bc("prescribed concentration", "end", "5", "c3"), "", ""),
    "multiphasic": (
        bc("prescribed fluid pressure", "end", f"{BATH}")
        + "".join(bc("prescribed concentration", "end", "100", c) for c in ("c1", "c2")),
        ic("fluid pressure", BATH) + "".join(ic("concentration", 100, c) for c in ("c1", "c2")),
        ic("shell fluid pressure", BATH) + "".join(ic("shell concentration", 100, d) for d in ("d1", "d2")),
    ),
}


def model(module: str, mesh: str, domains: str, behind: str = "", loads: str = "") -> str:
    one = MADE_OF[module]
    stiff = one.replace('id="1" name="m"', 'id="2" name="s"').replace("<E>1.0<", "<E>5<")
    boundary, start, _ = DRIVEN[module]
    made = deck(
        one + stiff, PRESSED + boundary, start + behind, steps=(6, 0.1), module=module, mesh=mesh, domains=domains,
        more=loads + RAMP,
    )  # fmt: skip
    return finished(made, module)


def shelled(module: str, mesh: str = "", loads: str = "") -> str:
    """A rod that a shell of thickness H closes, which lies in it."""
    top = ",".join(str(4 * N + i) for i in range(1, 5))
    mesh = rod(N, LENGTH)[0] + f'<Elements type="quad4" name="S"><elem id="99">{top}</elem></Elements>' + mesh
    return model(module, mesh, '<SolidDomain name="p" mat="m"/>' + shell("s"), DRIVEN[module][2], loads)


def layered(module: str) -> str:
    """The same of hexahedra alone, the last of which is as thick as the shell."""
    mesh = rod(N + 1, LENGTH)[0]
    heights = [LENGTH * k / N - (H if k == N else 0) for k in range(N + 1)] + [LENGTH]
    for k, z in enumerate(heights):
        for i, (x, y) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1)), 4 * k + 1):
            old = f'<node id="{i}">{x},{y},{LENGTH * k / (N + 1)}</node>'
            assert old in mesh
            mesh = mesh.replace(old, f'<node id="{i}">{x},{y},{z}</node>')
    first, last = mesh.split(f'<elem id="{N + 1}">')
    mesh = first + f'</Elements><Elements type="hex8" name="S"><elem id="{N + 1}">' + last
    return model(module, mesh, '<SolidDomain name="p" mat="m"/><SolidDomain name="S" mat="s"/>')


@pytest.mark.parametrize("module", MADE_OF)
def test_a_flat_shell_is_a_thin_solid(module: str, tmp_path: Path) -> None:
    """In front it has the displacements, pressures and concentrations of the thin layer's face, behind its other's."""
    a, b = (solve(text(module), tmp_path).isel(time=-1) for text in (shelled, layered))
    front, face, inner = slice(4 * N, 4 * N + 4), slice(4 * N + 4, None), slice(0, 4 * N)
    names = ["displacement", "effective_fluid_pressure"]
    names += [] if module == "biphasic" else ["effective_solute_concentration"]
    for name in names:
        x, y = a[name].values, b[name].values
        size = np.abs(y).max()
        assert size > 1e-3
        np.testing.assert_allclose(x[front], y[face], atol=1e-6 * size)
        np.testing.assert_allclose(x[inner], y[inner], atol=1e-6 * size)
    behind = a["effective_shell_fluid_pressure"].values[front]
    np.testing.assert_allclose(behind, b["effective_fluid_pressure"].values[front], rtol=1e-5)
    np.testing.assert_allclose(a["shell_displacement"].values[front], b["displacement"].values[front], atol=1e-6)
    x, y = a["fluid_flux"].values, b["fluid_flux"].values
    np.testing.assert_allclose(x, y, atol=1e-6 * np.abs(y).max())


# ---- conditions and loads on the back face -------------------------------------------------------------------------
PLATE = """<Nodes name="n"><node id="1">0,0,0</node><node id="2">1,0,0</node><node id="3">1,1,0</node>
<node id="4">0,1,0</node></Nodes><Elements type="quad4" name="S"><elem id="1">1,2,3,4</elem></Elements>
<NodeSet name="all">1,2,3,4</NodeSet><Surface name="face"><quad4 id="1">1,2,3,4</quad4></Surface>"""
DRAINED = bc("zero fluid pressure", "all")
SOLUTE_IN_FRONT = DRAINED + bc("prescribed concentration", "all", "2", "c3")


def plate(
    boundary: str, initial: str = "", loads: str = "", module: str = "biphasic", analysis: str = "STEADY-STATE"
) -> str:
    """A shell of thickness H that is held, of permeability K or a solute of diffusivity 0.3."""
    made = deck(
        MADE_OF[module], held("all") + held("all", "s") + boundary, initial, steps=(2, 0.5), module=module, mesh=PLATE,
        domains=shell("m"), analysis=analysis, more=f"<Loads>{loads}</Loads>",
    )  # fmt: skip
    return finished(made, module)


def nodal(dof: str, value: float) -> str:
    return f'<nodal_load type="nodal_load" node_set="all"><dof>{dof}</dof><scale>{value}</scale></nodal_load>'


def flux(what: str, value: float, surface: str = "face", more: str = "") -> str:
    return (
        f'<surface_load type="{what}flux" surface="{surface}">{more}<flux>{value}</flux>'
        "<shell_bottom>1</shell_bottom></surface_load>"
    )


def test_fluid_flows_down_the_pressure_s_gradient(tmp_path: Path) -> None:
    """w = K q / h through a shell with q behind and no pressure in front."""
    q = bc("prescribed shell fluid pressure", "all", "0.2")
    last = solve(plate(DRAINED + q), tmp_path).isel(time=-1)
    np.testing.assert_allclose(last["fluid_flux"].values, [[0, 0, K * 0.2 / H]], rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(last["effective_shell_fluid_pressure"].values, 0.2, rtol=1e-6)
    np.testing.assert_allclose(last["fluid_pressure"].values, 0.1, rtol=1e-6)
    np.testing.assert_allclose(last["nodal_shell_director"].values, [[0, 0, H]] * 4, atol=1e-7)
    np.testing.assert_allclose(last["shell_director"].values.reshape(-1, 3), [[0, 0, H]] * 4, atol=1e-7)
    np.testing.assert_allclose(last["shell_thickness"].values, H, rtol=1e-6)


def test_data_of_nodes_behind(tmp_path: Path) -> None:
    log = '<logfile><node_data data="p;q;sz" file="q.csv" delim=","/></logfile></Output>'
    q = bc("prescribed shell fluid pressure", "all", "0.2")
    solve(plate(DRAINED + q).replace("</Output>", log), tmp_path)
    assert (tmp_path / "q.csv").read_text().splitlines()[-4:] == [f"{n},0,0.2,0" for n in (1, 2, 3, 4)]


@pytest.mark.parametrize(("load", "w"), [(flux("fluid", 0.03), 0.03), (nodal("q", 0.03 / 4), -0.03)])
def test_fluid_is_driven_through_the_back(load: str, w: float, tmp_path: Path) -> None:
    """Normals of back faces point into the shell, so that a positive flux enters there; a nodal one leaves."""
    last = solve(plate(DRAINED, loads=load), tmp_path).isel(time=-1)
    np.testing.assert_allclose(last["fluid_flux"].values[0, 2], w, rtol=1e-6)
    np.testing.assert_allclose(last["effective_shell_fluid_pressure"].values, w * H / K, rtol=1e-6)


@pytest.mark.parametrize("name", ["c3", "Glc"])
def test_a_solute_enters_at_the_back(name: str, tmp_path: Path) -> None:
    """All that enters leaves in front; c behind is about j h / (phi D) above that in front, less for osmosis."""
    load = flux("solute", 0.6, more="<solute_id>3</solute_id>")
    text = plate(SOLUTE_IN_FRONT.replace("c3", name), loads=load, module="solute")
    last = solve(text, tmp_path).isel(time=-1)
    np.testing.assert_allclose(last["solute_flux"].values.ravel()[[2, 5, 8]].sum(), 0.6, rtol=1e-6)
    c = last["effective_shell_solute_concentration_Glc"].values
    assert c == pytest.approx(2.0 + 0.6 * H / (0.8 * 0.3), rel=0.2)


OLD = {  # what version 4.0 says of the plate, and version 3.0
    'version="4.0"': 'version="3.0"',
    DRAINED: '<bc type="fix" node_set="all"><dofs>p</dofs></bc>',
    held("all"): '<bc type="fix" node_set="all"><dofs>x,y,z</dofs></bc>',
    held("all", "s"): '<bc type="fix" node_set="all"><dofs>sx,sy,sz</dofs></bc>',
}


def test_version_3_prescribes_what_is_behind(tmp_path: Path) -> None:
    text = plate(DRAINED + '<bc type="prescribe" node_set="all"><dof>q</dof><scale>0.2</scale></bc>')
    for new, old in OLD.items():
        assert new in text
        text = text.replace(new, old)
    last = solve(text, tmp_path).isel(time=-1)
    np.testing.assert_allclose(last["fluid_flux"].values[0, 2], K * 0.2 / H, rtol=1e-6)


def test_what_is_behind_is_fixed_and_prescribed_by_old_types(tmp_path: Path) -> None:
    """Version 4.0 has no type of its own that fixes q or d, nor one that prescribes d."""
    given = bc("prescribed fluid pressure", "all", "0.2") + '<bc type="fix" node_set="all"><dofs>q</dofs></bc>'
    last = solve(plate(given), tmp_path).isel(time=-1)
    np.testing.assert_allclose(last["fluid_flux"].values[0, 2], -K * 0.2 / H, rtol=1e-6)
    d3 = '<bc type="prescribe" node_set="all"><dof>d3</dof><scale>4</scale></bc>'
    last = solve(plate(SOLUTE_IN_FRONT + d3, module="solute"), tmp_path).isel(time=-1)
    np.testing.assert_allclose(last["effective_shell_solute_concentration_Glc"].values, 4.0, rtol=1e-6)


def test_initial_values_behind(tmp_path: Path) -> None:
    start = ic("shell fluid pressure", 0.3) + ic("shell concentration", 4, "d3") + ic("concentration", 2, "c3")
    log = '<logfile><element_data data="p" file="p.csv" delim=","/></logfile></Output>'
    text = plate(SOLUTE_IN_FRONT, start, module="solute", analysis="TRANSIENT").replace("</Output>", log)
    first = solve(text, tmp_path).isel(time=0)
    assert (first["effective_shell_fluid_pressure"].values == np.float32(0.3)).all()
    assert (first["effective_shell_solute_concentration_Glc"].values == 4).all()
    np.testing.assert_allclose(first["fluid_pressure"].values, 0.15 + R * T * 3.0, rtol=1e-6)
    logged = float((tmp_path / "p.csv").read_text().splitlines()[3].split(",")[1])
    assert logged == pytest.approx(0.15 + R * T * 3.0)


@pytest.mark.parametrize("bottom", [0, 1])
def test_an_actual_pressure_on_either_face(bottom: int, tmp_path: Path) -> None:
    actual = (
        f'<bc type="actual fluid pressure" surface="face"><pressure>0.4</pressure>'
        f"<shell_bottom>{bottom}</shell_bottom></bc>"
    )
    other = bc("prescribed fluid pressure" if bottom else "prescribed shell fluid pressure", "all", "0.1")
    start = ic("concentration", 3, "c3") + ic("shell concentration", 3, "d3")
    last = solve(plate(other + actual, start, module="solute", analysis="TRANSIENT"), tmp_path).isel(time=-1)
    c = last["effective_solute_concentration"].sel(solute="Glc").values
    p, q = (last[f"effective_{s}fluid_pressure"].values for s in ("", "shell_"))
    d = last["effective_shell_solute_concentration_Glc"].values
    np.testing.assert_allclose(q if bottom else p, 0.4 - R * T * (d if bottom else c), rtol=1e-5)
    assert (p if bottom else q) == pytest.approx(0.1)


# ---- errors --------------------------------------------------------------------------------------------------------
LOW = '<Surface name="low"><quad4 id="1">1,4,3,2</quad4></Surface>'
BAD = {
    "no triphasic shells": plate("", module="multiphasic").replace('"m" type="multiphasic"', '"m" type="triphasic"'),
    "node 1 is in none": shelled("biphasic", loads=f"<Loads>{nodal('q', 1)}</Loads>"),
    'not "w"': plate('<bc type="fix" node_set="all"><dofs>w</dofs></bc>'),
    'type="elastic-shell"> of a biphasic': plate("").replace("<ShellDomain ", '<ShellDomain type="elastic-shell" '),
    "is no shell": shelled("biphasic", LOW, f"<Loads>{flux('fluid', 1, 'low')}</Loads>"),
}


@pytest.mark.parametrize("said", BAD)
def test_what_shells_are_not(said: str, tmp_path: Path) -> None:
    message = refused(BAD[said], tmp_path)
    assert said in message and "m.feb:" in message

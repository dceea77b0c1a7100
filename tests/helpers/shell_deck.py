"""Shells of mixtures on part of a cylinder, with solids behind or in front, as .feb text that FEBio reads too."""

from __future__ import annotations

from itertools import count

import numpy as np

R, T, FC, PHI = 8.314e-6, 310.0, 96.485e-6, 0.95
BATH = -R * T * PHI * 200.0  # effective pressure of a bath of 100 of each ion
IONS = (("Na", 0.01), ("Cl", 0.02))
ALL = (*IONS, ("Glc", 0.005))
SPECIES = """<Solutes>
<solute id="1" name="Na"><charge_number>1</charge_number><molar_mass>23</molar_mass></solute>
<solute id="2" name="Cl"><charge_number>-1</charge_number><molar_mass>35</molar_mass></solute>
<solute id="3" name="Glc"><charge_number>0</charge_number><molar_mass>180</molar_mass></solute></Solutes>"""
H = 0.05  # thickness
SHELL = f'<ShellDomain name="S" mat="s"><shell_thickness>{H}</shell_thickness></ShellDomain>'
SOLIDS = {"quad4": "hex8", "tri3": "penta6"}
PLOTTED = (
    "displacement", "shell displacement", "stress", "effective fluid pressure", "effective shell fluid pressure",
    "fluid flux",
)  # fmt: skip
SOLUTES = ("effective solute concentration", "solute concentration", "solute flux", "electric potential")


# ---- mesh ----------------------------------------------------------------------------------------------------------
def patch(kind: str, n: int = 2, radius: float = 1.0, angle: float = 0.8, length: float = 0.8):  # type: ignore[no-untyped-def]
    """Nodes (node, 3) and facets of n x n cells, and the places (i, j) of the nodes, up to the last."""
    s = 2 if kind in ("quad8", "tri6") else 1
    m, places, X, conn = s * n, {}, [], []

    def node(i: int, j: int) -> int:
        if (i, j) not in places:
            places[i, j] = len(X)
            t = angle * (i / m - 0.5)
            X.append((radius * np.sin(t), (length + 0.05 * np.sin(3 * i / m)) * j / m, radius * np.cos(t)))
        return places[i, j]

    for i, j in np.ndindex(n, n):
        c = [(s * i + a, s * j + b) for a, b in ((0, 0), (s, 0), (s, s), (0, s))]
        for corners in ((0, 1, 2, 3),) if kind.startswith("quad") else ((0, 1, 2), (0, 2, 3)):
            p = [c[k] for k in corners]
            if s == 2:
                p += [((a[0] + b[0]) // 2, (a[1] + b[1]) // 2) for a, b in zip(p, (*p[1:], p[0]))]
            conn.append([node(*q) for q in p])
    return np.array(X), np.array(conn), list(places), m


def mesh(kind: str, behind: int = 0, front: int = 0, depth: float = 0.4) -> str:
    """Shells S, ``behind`` layers of solids B on the inside and ``front`` layers A on the outside; node sets."""
    X, conn, places, m = patch(kind)
    n = len(X)
    order = [*range(0, -behind - 1, -1), *range(1, front + 1)]
    layers = {k: np.arange(n) + n * i for i, k in enumerate(order)}
    every = np.vstack([X * [1 + depth * k, 1, 1 + depth * k] for k in layers])
    ids = count(1)
    text = '<Nodes name="all">'
    text += "".join(f'<node id="{i}">{x:.12g},{y:.12g},{z:.12g}</node>' for i, (x, y, z) in enumerate(every, 1))
    parts = [("S", kind, conn)]
    for name, steps in (("B", range(-1, -behind - 1, -1)), ("A", range(front))):
        rows = [[*layers[k][c], *layers[k + 1][c]] for k in steps for c in conn]
        parts += [(name, SOLIDS[kind], rows)] if rows else []
    text += "</Nodes>" + "".join(
        f'<Elements type="{shape}" name="{name}">'
        + "".join(f'<elem id="{next(ids)}">{",".join(str(q + 1) for q in r)}</elem>' for r in rows)
        + "</Elements>"
        for name, shape, rows in parts
    )
    at = np.array([places[k % n] for k in range(len(every))])
    sets = {
        "shell": layers[0], "everything": np.arange(len(every)), "rim": np.flatnonzero((at[:, 0] % m) == 0),
        "side": np.flatnonzero(at[:, 1] == 0), "low": layers[-behind], "high": layers[front],
    }  # fmt: skip
    return text + "".join(
        f'<NodeSet name="{k}">{",".join(str(q + 1) for q in v)}</NodeSet>' for k, v in sets.items()
    )


# ---- materials -----------------------------------------------------------------------------------------------------
def _pores(E: float, k: float) -> str:
    return f"""<phi0>0.2</phi0><solid type="neo-Hookean"><density>1</density><E>{E}</E><v>0.2</v></solid>
<permeability type="perm-Holmes-Mow"><perm>{k}</perm><M>1.5</M><alpha>2</alpha></permeability>"""


def biphasic(i: int, name: str, E: float = 1.0, k: float = 1e-2) -> str:
    return f'<material id="{i}" name="{name}" type="biphasic">{_pores(E, k)}</material>'


def multiphasic(
    i: int, name: str, solutes: tuple = ALL, E: float = 1.0, k: float = 1e-2, charge: float = 0.0, more: str = ""
) -> str:  # fmt: skip
    each = "".join(
        f'<solute sol="{s}"><diffusivity type="diff-const-iso"><free_diff>{2 * d}</free_diff><diff>{d}</diff>'
        f'</diffusivity><solubility type="solub-const"><solub>1</solub></solubility></solute>'
        for s, d in solutes
    )
    return f"""<material id="{i}" name="{name}" type="multiphasic">{_pores(E, k)}
<osmotic_coefficient type="osm-coef-const"><osmcoef>{PHI}</osmcoef></osmotic_coefficient>
<fixed_charge_density>{charge}</fixed_charge_density>{each}{more}</material>"""


# ---- conditions ----------------------------------------------------------------------------------------------------
def zero(where: str, axes: str, s: str = "") -> str:
    dofs = "".join(f"<{s}{a}_dof>{int(a in axes)}</{s}{a}_dof>" for a in "xyz")
    return f'<bc type="zero {"shell " if s else ""}displacement" node_set="{where}">{dofs}</bc>'


def given(kind: str, where: str, value: float, dof: str = "", curve: int = 0) -> str:
    named = f"<dof>{dof}</dof>" if dof else ""
    lc = f' lc="{curve}"' if curve else ""
    return (
        f'<bc type="prescribed {kind}" node_set="{where}">{named}<value{lc}>{value}</value><relative>0</relative></bc>'
    )


def starts(concentrations: dict[int, float], back: bool = True) -> str:
    """Initial effective pressure BATH and concentrations by solute, on both faces of the shells."""
    faces = [("everything", "", "c")] + ([("shell", "shell ", "d")] if back else [])
    out = ""
    for where, s, letter in faces:
        out += f'<ic type="initial {s}fluid pressure" node_set="{where}"><value>{BATH}</value></ic>'
        out += "".join(
            f'<ic type="initial {s}concentration" node_set="{where}"><dof>{letter}{i}</dof><value>{v}</value></ic>'
            for i, v in concentrations.items()
        )
    return out


def deck(
    materials: str, mesh: str, domains: str, boundary: str, initial: str = "", module: str = "biphasic",
    analysis: str = "TRANSIENT", steps: int = 10,
) -> str:  # fmt: skip
    """``steps`` equal ones to t = 1; curve 1 rises to 1 at 0.5, curve 2 from 1 to 1.5 at 1."""
    ctol = "" if module == "biphasic" else "<ctol>1e-7</ctol>"
    plotted = PLOTTED if module == "biphasic" else PLOTTED + SOLUTES
    curves = "".join(
        f'<load_controller id="{k}" type="loadcurve"><interpolate>LINEAR</interpolate><extend>CONSTANT</extend>'
        f"<points><pt>{a}</pt><pt>{b}</pt></points></load_controller>"
        for k, a, b in ((1, "0,0", "0.5,1"), (2, "0,1", "1,1.5"))
    )
    return f"""<?xml version="1.0" encoding="ISO-8859-1"?>
<febio_spec version="4.0"><Module type="{module}"/><Control><analysis>{analysis}</analysis>
<time_steps>{steps}</time_steps><step_size>{1 / steps}</step_size>
<solver type="{module}"><symmetric_stiffness>non-symmetric</symmetric_stiffness>
<max_refs>80</max_refs><dtol>1e-7</dtol><etol>1e-11</etol><ptol>1e-7</ptol>{ctol}
<qn_method type="Broyden"><max_ups>0</max_ups></qn_method></solver></Control>
<Globals><Constants><T>{T}</T><R>{R}</R><Fc>{FC}</Fc></Constants>{SPECIES if ctol else ""}</Globals>
<Material>{materials}</Material><Mesh>{mesh}</Mesh><MeshDomains>{domains}</MeshDomains>
<Boundary>{boundary}</Boundary>{initial and f"<Initial>{initial}</Initial>"}<LoadData>{curves}</LoadData>
<Output><plotfile type="febio">{"".join(f'<var type="{v}"/>' for v in plotted)}</plotfile></Output></febio_spec>"""

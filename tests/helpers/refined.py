"""A bent bar whose mesh adaptors refine, as a .feb file."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import scenes

DECK = """<?xml version="1.0"?><febio_spec version="4.0"><Module type="{module}"/><Control>
<analysis>{analysis}</analysis><time_steps>{steps}</time_steps><step_size>0.25</step_size>
<solver type="{module}"><dtol>1e-9</dtol><etol>1e-9</etol><rtol>0</rtol>{solver}</solver>{stepper}</Control>
<Globals><Constants><T>0</T></Constants></Globals>
<Material>{material}</Material><Mesh><Nodes name="all">{nodes}</Nodes>{elements}{surfaces}
<NodeSet name="held">{held}</NodeSet></Mesh><MeshDomains>{domains}</MeshDomains>
<MeshAdaptor>{adaptor}</MeshAdaptor><Boundary><bc node_set="held" type="zero displacement"><x_dof>1</x_dof>
<y_dof>1</y_dof><z_dof>1</z_dof></bc>{more}<bc node_set="@surface:end" type="prescribed displacement"><dof>z</dof>
<value lc="1">0.5</value><relative>{relative}</relative></bc></Boundary>{loads}<LoadData>
<load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><extend>EXTRAPOLATE</extend><points>
<pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData><Output><plotfile type="febio">
<var type="displacement"/><var type="stress"/></plotfile></Output></febio_spec>"""
NEO = '<material id="1" name="m1" type="neo-Hookean"><density>1</density><E>1</E><v>0.3</v></material>'
STIFF = '<material id="2" name="m2" type="neo-Hookean"><density>1</density><E>3</E><v>0.2</v></material>'
MOONEY = ('<material id="1" name="m1" type="Mooney-Rivlin"><density>1</density><c1>1</c1><c2>0.2</c2><k>50</k>'
          "</material>")  # fmt: skip
VISCOUS = ('<material id="1" name="m1" type="viscoelastic"><density>1</density><g1>0.8</g1><t1>0.3</t1>'
           '<elastic type="neo-Hookean"><density>1</density><E>1</E><v>0.3</v></elastic></material>')
BIPHASIC = ('<material id="1" name="m1" type="biphasic"><phi0>0.2</phi0><solid type="neo-Hookean"><density>1</density>'
            '<E>1</E><v>0.3</v></solid><permeability type="perm-const-iso"><perm>0.1</perm></permeability></material>')
FLUID = {"module": "biphasic", "analysis": "TRANSIENT", "material": BIPHASIC,
         "more": '<bc node_set="@surface:top" type="zero fluid pressure"/>',
         "solver": "<symmetric_stiffness>non-symmetric</symmetric_stiffness><ptol>1e-9</ptol>"}  # fmt: skip
PRESSURE = '<surface_load surface="top" type="pressure"><pressure lc="1">0.02</pressure></surface_load>'
PULL = '<nodal_load node_set="@surface:end" type="nodal_load"><dof>x</dof><scale lc="1">0.002</scale></nodal_load>'
WEIGHT = '<body_load type="body force"><force lc="1">0,0,-0.01</force></body_load>'
AUTO = ("<time_stepper><max_retries>5</max_retries><opt_iter>11</opt_iter><dtmin>0.01</dtmin><dtmax>0.5</dtmax>"
        "</time_stepper>")  # fmt: skip
EVERY = '<criterion type="math"><math>1</math></criterion>'
ERROR = '<criterion type="relative error"><data type="stress"><metric>0</metric></data></criterion>'
CUT = ('<criterion type="relative error"><data type="min-max filter"><max>0.05</max><data type="stress"/></data>'
       "</criterion>")  # fmt: skip
ABOVE = ('<criterion type="min-max filter"><min>0.05</min><clamp>0</clamp><data type="stress"><metric>1</metric></data>'
         "</criterion>")  # fmt: skip
FACES = {"hex8": ("quad4", ((4, 5, 6, 7), (1, 2, 6, 5))),
         "tet4": ("tri3", ((0, 1, 3), (1, 2, 3), (2, 0, 3), (2, 1, 0)))}  # fmt: skip
TETS = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))


def chosen(elements: str) -> str:
    return f'<criterion type="element_selection"><element_list>{elements}</element_list></criterion>'


def adaptor(kind: str, inside: str = "", **options: Any) -> str:
    given = "".join(f"<{tag}>{value}</{tag}>" for tag, value in options.items())
    return f'<mesh_adaptor type="{kind}">{given}{inside}</mesh_adaptor>'


def deck(
    adaptor: str, n: tuple[int, int, int] = (4, 2, 2), kind: str = "hex8", *, steps: int = 2, parts: int = 1,
    module: str = "solid", analysis: str = "STATIC", material: str = NEO, loads: str = "", more: str = "",
    solver: str = "", stepper: str = "", relative: int = 0, first: int = 1,
) -> str:  # fmt: skip
    """A bent bar, held at one end, the other moved; ``first``: label of the first part's first element."""
    X, conn = scenes.grid(n, (4.0, 2.0, 2.0))
    if kind == "tet4":
        conn = np.concatenate([conn[:, list(t)][:, None] for t in TETS], axis=1).reshape(-1, 4)
    facet, faces = FACES[kind]
    every = np.concatenate([conn[:, list(f)] for f in faces])
    on = {"top": (X[every, 2] > 2 - 1e-9).all(axis=1), "end": (X[every, 0] > 4 - 1e-9).all(axis=1)}
    surfaces = "".join(
        f'<Surface name="{s}">' + "".join(f'<{facet} id="{k}">{joined(f + 1)}</{facet}>' for k, f in
                                          enumerate(every[rows], 1)) + "</Surface>" for s, rows in on.items()
    )  # fmt: skip
    ids = np.split(first + np.arange(len(conn)) if first == 1 else np.roll(np.arange(len(conn)) + 1, first), parts)
    held = np.flatnonzero(X[:, 0] < 1e-9) + 1
    X[:, 0] += 0.03 * X[:, 1] ** 2
    elements = "".join(
        f'<Elements type="{kind}" name="P{p}">'
        + "".join(f'<elem id="{i}">{joined(c + 1)}</elem>' for i, c in zip(own, rows)) + "</Elements>"
        for p, (own, rows) in enumerate(zip(ids, np.split(conn, parts)), 1)
    )  # fmt: skip
    return DECK.format(
        module=module, analysis=analysis, steps=steps, solver=solver, stepper=stepper, adaptor=adaptor, more=more,
        material=material + STIFF * (parts - 1), relative=relative, elements=elements, surfaces=surfaces,
        loads=f"<Loads>{loads}</Loads>" if loads else "", held=joined(held),
        nodes="".join(f'<node id="{k}">{x!r},{y!r},{z!r}</node>' for k, (x, y, z) in enumerate(X.tolist(), 1)),
        domains="".join(f'<SolidDomain name="P{p}" mat="m{p}"/>' for p in range(1, parts + 1)),
    ).replace("><", ">\n<")  # fmt: skip


def joined(numbers: Any) -> str:
    return ",".join(map(str, np.asarray(numbers).tolist()))

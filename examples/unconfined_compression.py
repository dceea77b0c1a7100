"""Unconfined compression of a cartilage plug between smooth impermeable platens, a quarter of it.

``python examples/unconfined_compression.py`` writes unconfined_compression.feb beside itself; the pressure in
the middle of the plug, relative to its mean axial stress, is what :func:`main` returns.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

RADIUS, HEIGHT = 1.5, 1.0  # mm

HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<!-- Stress relaxation of a cartilage plug in unconfined compression, one quarter of the plug.

     Units: mm, N, s; so stress in MPa, permeability in mm^4/(N s).
     The platens at z = 0 and z = 1 are smooth and impermeable; fluid leaves through the side, where p = 0.
     The top goes down by 5 % of the height in 10 s, then stays while the plug relaxes. -->
<febio_spec version="4.0">
  <Module type="biphasic"/>
  <Control>
    <analysis>TRANSIENT</analysis>
    <time_steps>{steps}</time_steps>
    <step_size>1</step_size>                        <!-- s -->
    <time_stepper type="default">
      <max_retries>10</max_retries>
      <opt_iter>15</opt_iter>
      <dtmin>0.01</dtmin>
      <dtmax lc="2">1</dtmax>                       <!-- s; the curve's points are times to be met -->
    </time_stepper>
    <solver type="biphasic">
      <symmetric_stiffness>symmetric</symmetric_stiffness>
      <max_refs>25</max_refs>
      <qn_method type="Broyden"/>
    </solver>
  </Control>
  <Globals>
    <Constants><T>0</T><P>0</P><R>0</R><Fc>0</Fc></Constants>
  </Globals>
  <Material>
    <material id="1" name="cartilage" type="biphasic">
      <phi0>0.2</phi0>                              <!-- solid volume fraction -->
      <fluid_density>0</fluid_density>
      <solid type="neo-Hookean">
        <density>1</density>
        <E>0.6</E>                                  <!-- MPa -->
        <v>0.1</v>
      </solid>
      <permeability type="perm-const-iso">
        <perm>0.002</perm>                          <!-- mm^4/(N s) -->
      </permeability>
    </material>
  </Material>
  <Mesh>
"""

TAIL = """  </Mesh>
  <MeshDomains>
    <SolidDomain name="plug" mat="cartilage"/>
  </MeshDomains>
  <Boundary>
    <bc name="symmetry in x" type="zero displacement" node_set="x0"><x_dof>1</x_dof></bc>
    <bc name="symmetry in y" type="zero displacement" node_set="y0"><y_dof>1</y_dof></bc>
    <bc name="lower platen" type="zero displacement" node_set="bottom"><z_dof>1</z_dof></bc>
    <bc name="upper platen" type="prescribed displacement" node_set="top">
      <dof>z</dof>
      <value lc="1">-0.05</value>                   <!-- mm -->
      <relative>0</relative>
    </bc>
    <bc name="free draining" type="zero fluid pressure" node_set="side"/>
  </Boundary>
  <LoadData>
    <load_controller id="1" name="ramp" type="loadcurve">
      <interpolate>LINEAR</interpolate>
      <extend>CONSTANT</extend>
      <points><pt>0,0</pt><pt>10,1</pt></points>
    </load_controller>
    <load_controller id="2" name="largest step" type="loadcurve">
      <interpolate>LINEAR</interpolate>
      <extend>CONSTANT</extend>
      <points><pt>0,1</pt><pt>10,1</pt><pt>20,5</pt><pt>100,25</pt><pt>{end},{last}</pt></points>
    </load_controller>
  </LoadData>
  <Output>
    <plotfile type="febio">
      <var type="displacement"/>
      <var type="effective fluid pressure"/>
      <var type="stress"/>
      <var type="fluid flux"/>
      <var type="relative volume"/>
      <var type="reaction forces"/>
    </plotfile>
  </Output>
</febio_spec>
"""


def quarter_disk(n: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Nodes (node, 2) and quads (3 n^2, 4) of a quarter of the unit disk: a bent square, and two rings."""
    s = np.linspace(0.0, 1.0, n + 1)
    u, v = np.meshgrid(s, s, indexing="ij")
    square = np.stack([0.55 * u * (1 - 0.12 * v), 0.55 * v * (1 - 0.12 * u)], axis=-1)

    def ring(inner: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
        a = np.radians(np.linspace(low, high, n + 1))
        arc = np.stack([np.cos(a), np.sin(a)], axis=-1)
        return inner[None] * (1 - s[:, None, None]) + arc[None] * s[:, None, None]

    blocks = [square, ring(square[-1], 0.0, 45.0), ring(square[::-1, -1], 45.0, 90.0)]
    x = np.concatenate([b.reshape(-1, 2) for b in blocks])
    _, first, same = np.unique(np.round(x, 9), axis=0, return_index=True, return_inverse=True)
    k = np.arange(len(x)).reshape(3, n + 1, n + 1)
    quads = np.stack([k[:, :-1, :-1], k[:, 1:, :-1], k[:, 1:, 1:], k[:, :-1, 1:]], axis=-1).reshape(-1, 4)
    return x[first], same.reshape(-1)[quads]


def plug(n: int, layers: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Nodes (node, 3) and hexahedra (3 n^2 layers, 8) of the quarter plug."""
    flat, quads = quarter_disk(n)
    m = len(flat)
    z = np.repeat(np.linspace(0.0, HEIGHT, layers + 1), m)
    X = np.column_stack([np.tile(RADIUS * flat, (layers + 1, 1)), z])
    conn = np.concatenate([np.hstack([quads + k * m, quads + (k + 1) * m]) for k in range(layers)])
    return X, conn


def text(n: int = 6, layers: int = 4, end: float = 1000.0) -> str:
    """The whole input file."""
    X, conn = plug(n, layers)
    sets = {
        "x0": X[:, 0] < 1e-9, "y0": X[:, 1] < 1e-9, "bottom": X[:, 2] < 1e-9, "top": X[:, 2] > HEIGHT - 1e-9,
        "side": np.hypot(X[:, 0], X[:, 1]) > RADIUS - 1e-9,
    }  # fmt: skip
    out = [HEAD.format(steps=int(end)), '    <Nodes name="all">\n']
    out += [f'      <node id="{i}">{x:.9g},{y:.9g},{z:.9g}</node>\n' for i, (x, y, z) in enumerate(X, 1)]
    out += ["    </Nodes>\n", '    <Elements type="hex8" name="plug">\n']
    out += [f'      <elem id="{i}">{",".join(map(str, c))}</elem>\n' for i, c in enumerate(conn + 1, 1)]
    out.append("    </Elements>\n")
    for name, where in sets.items():
        ids = ",".join(map(str, np.flatnonzero(where) + 1))
        out.append(f'    <NodeSet name="{name}">{ids}</NodeSet>\n')
    return "".join([*out, TAIL.replace("{end}", f"{end:g}").replace("{last}", f"{end / 10:g}")])


def main(folder: Path, n: int = 6, layers: int = 4, end: float = 1000.0) -> float:
    """Solve; returns the fluid's share of the mean axial stress in the middle of the plug after the ramp."""
    import febkit

    path = folder / "unconfined_compression.feb"
    path.write_text(text(n, layers, end))
    plot = path.with_suffix(".xplt")
    result = febkit.solve(febkit.read(path), plotfile=plot, logfile=path.with_suffix(".log"))
    assert result.converged, result.reason
    ds = febkit.open_results(plot).sel(time=10.0, method="nearest")
    x, y, z = np.asarray(ds["X"]).T
    axial = np.asarray(ds["reaction_forces"])[z > 0.999 * HEIGHT, 2].sum() / (0.25 * np.pi * RADIUS**2)
    pressure = np.asarray(ds["effective_fluid_pressure"])
    return float(pressure[np.hypot(x, y) < 1e-6].mean() / abs(axial))


if __name__ == "__main__":
    here = Path(__file__).parent
    (here / "unconfined_compression.feb").write_text(text())
    print("the fluid's share of the load in the middle:", main(Path(sys.argv[1]) if sys.argv[1:] else here))

"""Small models of the experiments that materials are fitted to, with the parameters that their data tell."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import febkit
from febkit import materials
from febkit.fitting.parameters import Spec
from febkit.model import Component

NEWTON = {"dtol": 1e-4, "qn_method": Component("qn_method", "full Newton")}


@dataclass(frozen=True)
class Specimen:
    """A test: its model at given parameters, when it is measured, what, and where a fit may look."""

    model: Callable[..., febkit.Model]
    truth: Mapping[str, float]
    bounds: Mapping[str, Spec]
    times: np.ndarray
    observe: Any

    def at(self, values: Mapping[str, float]) -> febkit.Model:
        m = self.model()
        for path, v in values.items():
            m[path] = v
        return m

    def measured(self) -> np.ndarray:
        """(n, 1 + observables) times and true curves, without noise."""
        from febkit.observe import observables, variables

        m, observed = self.at(self.truth), observables(self.observe)
        result = m.solve(at=self.times, variables=variables(observed, m.record), threads=1)
        assert result, result.reason
        curves = [np.asarray(o(result.dataset).values, float) for o in observed.values()]
        return np.column_stack([self.times, *curves])


def _plug(solid: Any, n: tuple[int, int] = (4, 1)) -> febkit.Model:
    """A quarter of a biphasic plug between frictionless plates, its mantle free to drain."""
    m = febkit.Model("biphasic", units="mm-N-s")
    m.add_cylinder("plug", radius=2, height=1, n=n, sector="quarter")
    m.materials["c"] = materials.Biphasic(solid=solid, permeability=materials.PermConstIso(perm=2e-3), phi0=0.2)
    m.node_sets["top"] = m.nodes(z="max")
    m.fix(m.nodes(z="min"), "z")
    m.fix(m.nodes(x="min"), "x")
    m.fix(m.nodes(y="min"), "y")
    m.fix(m.nodes(where=lambda X: np.abs(np.hypot(X[:, 0], X[:, 1]) - 2) < 1e-6), "p")
    return m


def unconfined() -> febkit.Model:
    m = _plug(materials.NeoHookean(E=0.6, v=0.15))
    m.prescribe("top", z=-0.1, curve=[(0, 0), (20, 1)])
    m.step(time=4000, dt=4, dtmax=500, solver=NEWTON).control.time_stepper.dtforce = 1
    return m


def fibres() -> febkit.Model:
    """Stretched, then compressed: fibres hold in tension alone, along the axis and across it."""
    fibers = materials.of("ellipsoidal fiber distribution", ksi=(0.8,) * 3, beta=(2.5,) * 3)
    solid = materials.SolidMixture(solid=[materials.NeoHookean(E=0.5, v=0.1), fibers])
    m = _plug(solid, n=(2, 1))
    m.prescribe("top", z=0.2, curve=[(0, 0), (20, 0.5), (1000, 0.5), (1020, 1), (2500, 1), (2560, -1), (4000, -1)])
    m.step(time=4000, dt=5, dtmax=500, solver=NEWTON)
    return m


def confined() -> febkit.Model:
    """A column of Holmes-Mow tissue under two ramps, the second finds it stiffened."""
    m = febkit.Model("biphasic", units="mm-N-s")
    m.add_block("plug", (1, 1, 1), (1, 1, 6), bias=(1, 1, 0.8))
    m.materials["c"] = materials.Biphasic(solid=materials.of("Holmes-Mow", E=0.5, v=0.1, beta=0.8),
                                          permeability=materials.PermConstIso(perm=2e-3), phi0=0.2)  # fmt: skip
    m.node_sets["top"] = m.nodes(z="max")
    m.fix(m.nodes(), "x", "y")
    m.fix(m.nodes(z="min"), "z")
    m.fix("top", "p")
    m.prescribe("top", z=-0.3, curve=[(0, 0), (50, 0.5), (2000, 0.5), (2050, 1), (4000, 1)])
    m.step(time=4000, dt=10, dtmax=500, solver=NEWTON)
    return m


def relaxing() -> febkit.Model:
    """A viscoelastic bar, stretched and held."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("bar", (1, 1, 1), (1, 1, 1))
    m.materials["c"] = materials.of("viscoelastic", elastic=materials.NeoHookean(E=1.0, v=0.3), t1=20.0, g1=0.6)
    m.node_sets["top"] = m.nodes(z="max")
    for axis in "xyz":
        m.fix(m.nodes(**{axis: "min"}), axis)
    m.prescribe("top", z=0.1, curve=[(0, 0), (2, 1)])
    m.step(time=100, dt=1, dtmax=10, solver=NEWTON)
    return m


def indented() -> febkit.Model:
    """A quarter of a biphasic layer under a rigid ball, impermeable where it touches nothing."""
    m = febkit.Model("biphasic", units="mm-N-s")
    m.add_block("layer", (3, 3, 1), (4, 4, 2), bias=(1.4, 1.4, 0.8))
    m.materials["c"] = materials.Biphasic(solid=materials.NeoHookean(E=0.5, v=0.1),
                                          permeability=materials.PermConstIso(perm=2e-3), phi0=0.2)  # fmt: skip
    a = np.linspace(0, 1.6, 5)
    X = np.array([(x, y, 1 + (x * x + y * y) / 8 + 1e-3) for y in a for x in a])
    quads = [(5 * j + i, 5 * j + i + 1, 5 * j + i + 6, 5 * j + i + 5) for j in range(4) for i in range(4)]
    m.add_part("ball", "quad4", X, np.array(quads)[:, ::-1])
    m.materials["ball"] = materials.of("rigid body", density=1, center_of_mass=(0, 0, 5))
    m.assign("c", "layer")
    m.assign("ball", "ball")
    m.surfaces["under"] = m.faces(part="ball")
    m.surfaces["over"] = m.faces(part="layer", z=1.0)
    m.fix(m.nodes(part="layer", z="min"), "x", "y", "z")
    m.fix(m.nodes(part="layer", x="min"), "x")
    m.fix(m.nodes(part="layer", y="min"), "y")
    m.fix(m.nodes(part="layer", z=1.0), "p")
    m.touch("over", "under", "sliding-elastic", penalty=5.0, auto_penalty=True)
    m.fix_body("ball", "Rx", "Ry", "Ru", "Rv", "Rw")
    m.move_body("ball", z=-0.15, curve=[(0, 0), (20, 1)])
    m.step(time=2000, dt=4, dtmax=300, solver=NEWTON)
    return m


RAMP = np.array([4, 8, 12, 16, 20, 40, 70, 110, 170, 250, 350, 500, 700, 1000, 1400, 2000, 3000, 4000.0])
TWO = np.array([2, 5, 10, 15, 20, 60, 150, 300, 600, 1000, 1002, 1005, 1010, 1015, 1020, 1060, 1150, 1300, 1600, 2000,
                2500, 2505, 2515, 2530, 2545, 2560, 2600, 2700, 2900, 3300, 4000.0])  # fmt: skip
HELD = np.array([5, 10, 20, 30, 40, 50, 80, 150, 300, 600, 1000, 1500, 2000, 2005, 2010, 2020, 2030, 2040, 2050, 2080,
                 2150, 2300, 2600, 3000, 3500, 4000.0])  # fmt: skip
SPECIMENS = {
    "unconfined": Specimen(
        unconfined, {"c.solid.E": 0.6, "c.solid.v": 0.15, "c.permeability.perm": 2e-3},
        {"c.solid.E": (0.1, 0.9, 3.0), "c.solid.v": (0.0, 0.25, 0.45),
         "c.permeability.perm": febkit.Parameter(1e-4, 4e-3, 1e-1, log=True)}, RAMP, "reaction top z"),
    "fibres": Specimen(
        fibres, {"c.solid.solid[0].E": 0.5, "c.solid.solid[1].ksi[0]": 0.8, "c.solid.solid[1].ksi[1]": 0.8,
                 "c.solid.solid[1].ksi[2]": 0.8, "c.solid.solid[1].beta[0]": 2.5, "c.solid.solid[1].beta[1]": 2.5,
                 "c.solid.solid[1].beta[2]": 2.5, "c.permeability.perm": 2e-3},
        {"c.solid.solid[0].E": (0.1, 0.7, 3.0), tuple(f"c.solid.solid[1].ksi[{k}]" for k in range(3)): (0.05, 1.2, 5.0),
         tuple(f"c.solid.solid[1].beta[{k}]" for k in range(3)): (2.0, 2.8, 4.5),
         "c.permeability.perm": febkit.Parameter(1e-4, 3e-3, 1e-1, log=True)}, TWO, "reaction top z"),
    "Holmes-Mow": Specimen(
        confined, {"c.solid.E": 0.5, "c.solid.beta": 0.8, "c.permeability.perm": 2e-3},
        {"c.solid.E": (0.1, 0.8, 3.0), "c.solid.beta": (0.05, 0.4, 3.0),
         "c.permeability.perm": febkit.Parameter(1e-4, 4e-3, 1e-1, log=True)}, HELD, "reaction top z"),
    "viscoelastic": Specimen(
        relaxing, {"c.elastic.E": 1.0, "c.g1": 0.6, "c.t1": 20.0},
        {"c.elastic.E": (0.2, 1.5, 5.0), "c.g1": (0.05, 0.3, 3.0), "c.t1": febkit.Parameter(1.0, 8.0, 200.0, log=True)},
        np.array([0.5, 1, 1.5, 2, 3, 5, 8, 12, 18, 25, 35, 50, 70, 100.0]), "reaction top z"),
    "indentation": Specimen(
        indented, {"c.solid.E": 0.5, "c.solid.v": 0.1, "c.permeability.perm": 2e-3},
        {"c.solid.E": (0.1, 0.8, 3.0), "c.solid.v": (0.0, 0.2, 0.45),
         "c.permeability.perm": febkit.Parameter(1e-4, 4e-3, 1e-1, log=True)},
        np.array([4, 8, 12, 16, 20, 30, 50, 80, 120, 200, 350, 600, 1000, 2000.0]), "reaction ball z"),
}  # fmt: skip

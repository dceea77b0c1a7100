"""Beams that shear, of any rotation: displacements of the axis and rotations of the cross-sections.

Strains: Gamma = R^T dx/dS - E3, K = R^T k; spatial forces t = R D1 Gamma and moments m = R D2 K, with D1 = diag(G A1,
G A2, E A) and D2 = diag(E I1, E I2, G (I1 + I2)) in the axes E1 E2 E3 of the cross-section. The rotations R and the
curvatures k at the points are updated by interpolated increments of each iteration, from the state after the last one.
Simo and Vu-Quoc, Comput Methods Appl Mech Engrg 58 (1986) 79 and 66 (1988) 125; FEBio Theory Manual, "Beams".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..fields import DISPLACEMENT, ROTATION, Field
from ..points import VOIGT
from ..quaternions import conjugate, cross, identity, matrix, of_vector, product, rotate, skew
from ..rotations import Rotations
from ..values import as_value
from . import register
from .base import Floats, Physics, Work

if TYPE_CHECKING:
    from ..action import Matrices
    from ..group import Chunk, Group
    from ..lines import Lines
    from ..solids.base import Number
    from ..state import State
    from ..tangent import Target, Workspace

ORIGIN = np.zeros((1, 3))


def frames(axis: Floats) -> Floats:
    """Axes E1 E2 E3 of cross-sections as columns (m, 3, 3): E3 along the beam, E2 = E3 x X, or E3 x Y for E3 near X."""
    along = np.abs(axis[:, 0]) > 0.5
    E2 = np.cross(axis, np.where(along[:, None], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]))
    E2 /= np.linalg.norm(E2, axis=1)[:, None]
    return np.stack([np.cross(E2, axis), E2, axis], axis=2)


class BeamWork(Work):
    """q, k: rotations (m, g, 4) and curvatures (m, g, 3) at the points, q0 and k0 after the last iteration; t, moment:
    forces and moments; slope: dx/dS."""

    memory: ClassVar[tuple[str, ...]] = ("q", "k", "q0", "k0", "t", "moment", "slope")
    held: ClassVar[Mapping[str, str]] = {"t": "beam stress", "moment": "beam stress couple"}
    spins: ClassVar[bool] = True
    pull: ClassVar[float] = -1.0  # FEBio gives body forces the opposite sign in beams
    group: Lines

    def __init__(self, group: Group, physics: Beam) -> None:
        super().__init__(group, physics)
        m, g = group.m, group.g
        self.law = physics
        self.E = frames(self.group.axis)
        self.q, self.k = identity(m, g), np.zeros((m, g, 3))
        self.q0, self.k0 = self.q.copy(), self.k.copy()
        self.t, self.moment = np.zeros((m, g, 3)), np.zeros((m, g, 3))
        self.slope = np.repeat(self.group.axis[:, None], g, axis=1)
        self.moduli_at(0.0)

    def symmetric(self, steady: bool) -> bool:
        return False

    def moduli_at(self, t: float) -> None:
        """Moduli D1, D2 (m, 1, 3, 3) in global axes."""
        p = self.law
        E, G = (float(as_value(v)(t, ORIGIN)[0]) for v in (p.E, p.G))
        D = np.diag([G * p.A1, G * p.A2, E * p.A]), np.diag([E * p.I1, E * p.I2, G * (p.I1 + p.I2)])
        self.D1, self.D2 = ((self.E @ d @ np.swapaxes(self.E, 1, 2))[:, None] for d in D)

    # ---- strains and forces -----------------------------------------------------------------------
    def update(self, c: Chunk, state: State, drive: list[Any]) -> None:
        e = slice(c.lo, c.hi)
        g = self.group
        self._turn(e, state.extra["turn"][g.conn[e]] if "turn" in state.extra else np.zeros((c.hi - c.lo, g.n, 3)))
        self.slope[e] = np.einsum("ega,eai->egi", g.slope[e], state.x[g.conn[e]])
        self.moduli_at(state.time)
        R = matrix(self.q[e])
        for D, strain, force in ((self.D1, self.strain(e), self.t), (self.D2, self.bend(e), self.moment)):
            force[e] = (R @ D[e] @ strain[..., None])[..., 0]

    def _turn(self, e: slice, turn: Floats) -> None:
        """Rotations and curvatures after increments ``turn`` (element, node, 3) from the last iteration's.

        k = dexp(d) d' + exp(d) k0, d the interpolated increment and d' its derivative by length.
        """
        d = np.einsum("ga,eai->egi", self.group.N, turn)
        ds = np.einsum("ega,eai->egi", self.group.slope[e], turn)
        r = of_vector(d)
        a = np.sqrt((d * d).sum(axis=-1, keepdims=True))
        axis = d / np.where(a > 0.0, a, 1.0)
        g1, g2 = np.sinc(a / np.pi), np.sinc(0.5 * a / np.pi)
        along = (axis * ds).sum(axis=-1, keepdims=True)
        self.k[e] = g1 * ds + (1.0 - g1) * along * axis + 0.5 * g2**2 * cross(d, ds) + rotate(r, self.k0[e])
        self.q[e] = product(r, self.q0[e])

    def settle(self) -> None:
        self.q0[...], self.k0[...] = self.q, self.k

    def strain(self, e: slice = slice(None)) -> Floats:
        """Gamma (e, g, 3)."""
        return rotate(conjugate(self.q[e]), self.slope[e]) - self.group.axis[e, None]

    def bend(self, e: slice = slice(None)) -> Floats:
        """K (e, g, 3)."""
        return rotate(conjugate(self.q[e]), self.k[e])

    # ---- residual and tangent ---------------------------------------------------------------------
    def residual(self, lo: int, hi: int, state: State, R: Floats, steady: bool) -> None:
        g, e = self.group, slice(lo, hi)
        f = np.empty((hi - lo, g.n, 6))
        f[..., :3] = np.einsum("eg,ega,egi->eai", g.dS[e], g.slope[e], self.t[e])
        f[..., 3:] = np.einsum("eg,ega,egi->eai", g.dS[e], g.slope[e], self.moment[e])
        f[..., 3:] -= np.einsum("eg,ga,egi->eai", g.dS[e], g.N, cross(self.slope[e], self.t[e]))
        np.add.at(R, (g.conn[e][..., None], g.columns), -f)

    def tangent(self, c: Chunk, state: State, target: Target, work: Workspace, steady: bool) -> None:
        """Linear in further rotations of the points; taken at the end of the step whatever alpha_f is."""
        g, e = self.group, slice(c.lo, c.hi)
        R = matrix(self.q[e])
        c1, c2 = (R @ D[e] @ np.swapaxes(R, -1, -2) for D in (self.D1, self.D2))
        S, T, M = skew(self.slope[e]), skew(self.t[e]), skew(self.moment[e])
        w, G, H = g.dS[e], g.slope[e], np.broadcast_to(g.N, (c.hi - c.lo, *g.N.shape))
        K = np.empty((c.hi - c.lo, 2, 3, g.n, 2, 3, g.n))

        def put(a: int, b: int, *terms: tuple[Floats, Floats, Floats]) -> None:
            K[:, a, :, :, b] = sum(np.einsum("eg,ega,egij,egb->eiajb", w, A, X, B) for A, X, B in terms)

        put(0, 0, (G, c1, G))
        put(0, 1, (G, c1 @ S - T, H))
        put(1, 0, (H, T - S @ c1, G))
        put(1, 1, (G, c2, G), (G, -M, H), (H, S @ T - S @ c1 @ S, H))
        target.add(g, c.lo, c.hi, K.reshape(len(K), 6 * g.n, 6 * g.n) / g.alphaf)

    # ---- inertia ----------------------------------------------------------------------------------
    def mass(self) -> tuple[Floats, Floats | None]:
        return np.full((self.group.m, self.group.g), self.law.density), None

    def _inertia(self) -> Floats:
        """Spatial inertia of the cross-sections per length (m, g, 3, 3)."""
        p, R = self.law, matrix(self.q)
        I = self.E @ (p.density * np.diag([p.I1, p.I2, p.I1 + p.I2])) @ np.swapaxes(self.E, 1, 2)
        return np.asarray(R @ I[:, None] @ np.swapaxes(R, -1, -2))

    def _at_points(self, nodal: Floats) -> Floats:
        return np.einsum("ga,eai->egi", self.group.N, nodal[self.group.conn])

    def inertia(self, state: State, R: Floats) -> None:
        """Rates of linear and angular momentum, rho A x'' and I a + w x I w, at the end of the step (as in FEBio)."""
        g, I = self.group, self._inertia()
        w, a = (self._at_points(state.extra[n]) for n in ("spin", "spin rate"))
        f = np.empty((g.m, g.n, 6))
        acc = self._at_points(state.acceleration)
        f[..., :3] = np.einsum("eg,ga,egi->eai", self.law.density * g.wJ0, g.N, acc)
        dh = (I @ a[..., None])[..., 0] + cross(w, (I @ w[..., None])[..., 0])
        f[..., 3:] = np.einsum("eg,ga,egi->eai", g.dS, g.N, dh)
        np.add.at(R, (g.conn[..., None], g.columns), -f)

    def inertia_tangent(self, state: State, rule: tuple[float, float]) -> Matrices:
        g, p = self.group, self.law
        start = state.time == 0.0
        a = 1.0 if start else 1.0 / (rule[0] * state.dt**2)
        K = np.zeros((g.m, 2, 3, g.n, 2, 3, g.n))
        M = np.einsum("eg,ga,gb->eab", p.density * a * g.wJ0, g.N, g.N)
        for i in range(3):
            K[:, 0, i, :, 0, i] = M
        K[:, 1, :, :, 1] = np.einsum("eg,ga,gb,egij->eiajb", g.dS, g.N, g.N, self._inertia()) if start else (
            self._spin_tangent(state, rule)
        )
        nodes = np.tile(g.conn.astype(np.int64), (1, 6))
        return [(K.reshape(g.m, 6 * g.n, 6 * g.n), nodes, np.repeat(g.columns, g.n))]

    def _spin_tangent(self, state: State, rule: tuple[float, float]) -> Floats:
        """d(I a + w x I w) by further rotations of the nodes (m, 3, n, 3, n)."""
        g, I = self.group, self._inertia()
        w, a = (self._at_points(state.extra[n]) for n in ("spin", "spin rate"))
        dw, da = Rotations.slopes(state, rule, g.conn)
        W, h, b = skew(w), (I @ w[..., None])[..., 0], (I @ a[..., None])[..., 0]
        turned = I @ skew(a) - skew(b) + W @ (I @ W - skew(h))  # by a rotation of the points
        by_w = W @ I - skew(h)
        by_node = turned[:, :, None] + by_w[:, :, None] @ dw[:, None] + I[:, :, None] @ da[:, None]
        weight = g.dS[:, :, None, None] * g.N[None, :, :, None] * g.N[None, :, None, :]
        return np.asarray(np.einsum("egab,egbij->eiajb", weight, by_node))

    # ---- what is written --------------------------------------------------------------------------
    def _stress(self) -> Floats:
        """sum_i (t . t_i) t_i t_i with the turned axes t_i of the cross-section (m, g, 6)."""
        axes = matrix(self.q) @ self.E[:, None]
        T = np.einsum("egia,egja,ega->egij", axes, axes, np.einsum("egi,egia->ega", self.t, axes))
        return np.stack([T[..., i, j] for i, j in VOIGT], axis=-1)

    outputs = {
        "stress": lambda w: w._stress(),
        "beam stress": lambda w: w.t,
        "beam stress couple": lambda w: w.moment,
        "beam reference stress": lambda w: rotate(conjugate(w.q), w.t),
        "beam reference stress couple": lambda w: rotate(conjugate(w.q), w.moment),
        "beam strain": lambda w: rotate(w.q, w.strain()),
        "beam curvature": lambda w: w.k,
    }


@dataclass(eq=False)
class Beam(Physics):
    """A straight beam. ``A`` area, ``A1``, ``A2`` those that shear, ``I1``, ``I2`` second moments of area about E1, E2.

    FEBio User Manual, "Linear beam".
    """

    E: Number = 0.0
    G: Number = 0.0
    A: float = 0.0
    A1: float = 0.0
    A2: float = 0.0
    I1: float = 0.0
    I2: float = 0.0
    density: float = 1.0
    name: ClassVar[str] = "beam"
    work: ClassVar[type[Work]] = BeamWork

    @property
    def fields(self) -> tuple[Field, ...]:
        return DISPLACEMENT, ROTATION

    @property
    def area(self) -> float:
        """Of the cross-section, which has mass."""
        return self.A


register(Beam, "beam")

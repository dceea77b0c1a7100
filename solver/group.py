"""A block at work: its integration points, stresses and element matrices.

Elements are cut into chunks small enough for the cache; a chunk goes through kinematics, material and
assembly in turn, so that no material needs to know an element, nor an element a material.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import elements
from .fields import DISPLACEMENT, Layout
from .kernels import solid
from .law import PoreCollapse
from .points import Points
from .problem import Block
from .record import variable_record
from .solids import history
from .state import State

Floats = NDArray[np.float64]
CACHE = 600_000  # bytes of factors of element tangents worked on at a time (:mod:`.kernels.blocks`)


class ElementFailure(RuntimeError):
    """An element that cannot go on; the message names it, its part and why."""


class Impossible(ElementFailure):
    """What no smaller step would help."""


class NegativeJacobian(ElementFailure):
    """An element turned inside out; ``element`` is its label, ``part`` its block."""

    def __init__(self, element: int, part: str) -> None:
        self.element, self.part = element, part
        super().__init__(f"element {element} of part {part!r} turned inside out (negative Jacobian)")


@variable_record
class Chunk:
    """Elements lo:hi of a group, their points, and which of the group's chunks it is."""

    lo: int
    hi: int
    points: Points
    number: int


class Group:
    """Element arrays of one block. m elements, g integration points, n nodes per element.

    F (m, g, 3, 3) and J (m, g) are those of the displacements, where these are among the block's ``fields`` (``moves``)
    and its elements have a volume (``deforms``); ``columns`` are those of its fields in nodal arrays, in the physics'
    order.
    """

    def __init__(self, block: Block, X: Floats, chunk: int = 256, layout: Layout | None = None) -> None:
        self.block = block
        fields = block.physics.fields
        self.layout = layout or Layout.of(fields)
        self.fields = tuple(f.name for f in fields)
        self.columns = self.layout.columns(*self.fields)
        self.moves = self.deforms = DISPLACEMENT.name in self.fields
        e = elements.get(block.element, block.rule)
        self.element = e
        self.shell = block.element.startswith("shell_")
        self.alphaf = 1.0  # weight of the step's end in its internal forces, where the pressure goes by the end alone
        self.steady = False  # is the analysis a steady state?
        self.N, self.dN = np.ascontiguousarray(e.N), np.ascontiguousarray(e.dN)
        self.conn = np.ascontiguousarray(block.conn, dtype=np.int32)
        m, g = len(self.conn), len(e.weights)
        self.m, self.g, self.n = m, g, self.conn.shape[1]
        self.iJ0, self.wJ0 = np.empty((m, g, 3, 3)), np.empty((m, g))
        self._measure(X)
        self.F = np.tile(np.eye(3), (m, g, 1, 1))
        self.J = np.ones((m, g))
        self.Xg = np.einsum("ga,eai->egi", self.N, X[self.conn]).reshape(-1, 3)
        self.extra: dict[str, Floats] = {}
        self.alive, self._size = np.ones(m, bool), chunk  # elements that were not eroded
        self.chunks = self._cut()
        self.set_history(history.initial(block.solid, m * g))
        self._grows = history.grows(block.solid)
        self.physics = block.physics.open(self)

    def _measure(self, X: Floats) -> None:
        """Inverse Jacobians and weights of the reference. Raises NegativeJacobian, but for shells (:meth:`folded`)."""
        w = np.ascontiguousarray(self.element.weights)
        if solid.reference(X, self.conn, self.dN, w, self.iJ0, self.wJ0):
            bad = self.wJ0 == 0 if self.shell else self.wJ0 <= 0
            for first in np.flatnonzero(bad.any(axis=1))[:1]:
                raise NegativeJacobian(int(self.block.ids[first]), self.block.name)

    def folded(self) -> str:
        """What to warn of where shells are thicker than they are bent: as in FEBio their volume is negative there."""
        bad = np.flatnonzero((self.wJ0 < 0).any(axis=1))
        if not len(bad):
            return ""
        return (
            f"part {self.block.name!r}: {len(bad)} of {self.m} shell elements are folded over within their thickness, "
            f"the first is {self.block.ids[bad[0]]}; as in FEBio their volume counts as negative there"
        )

    def share(self, **arrays: Floats) -> None:
        """Have laws see arrays of all points (m g, ...), which may change, as ``extra`` of theirs."""
        self.extra |= arrays
        self.chunks = self._cut()
        self._share_history()

    def _axes(self) -> Floats | None:
        Q = self.block.axes
        if Q is None:
            return None
        return np.repeat(Q, self.g, axis=0) if Q.ndim == 3 else Q.reshape(-1, 3, 3)

    def _cut(self) -> list[Chunk]:
        """Chunks of elements that are there."""
        F, J, g, Q = self.F.reshape(-1, 3, 3), self.J.reshape(-1), self.g, self._axes()
        out: list[Chunk] = []
        for first, end in self._runs():
            pieces = max(1, -(-(end - first) // self._size))
            for i in range(pieces):
                lo, hi = (first + (end - first) * k // pieces for k in (i, i + 1))
                q = slice(lo * g, hi * g)
                pts = Points(F[q], J[q], self.Xg[q], np.repeat(np.arange(lo, hi), g))
                pts.Q = None if Q is None else np.ascontiguousarray(Q[q])
                pts.extra = {k: v[q] for k, v in self.extra.items()}
                out.append(Chunk(lo, hi, pts, len(out)))
        return out

    def _runs(self) -> list[tuple[int, int]]:
        """(first, one past the last) of elements in a row that are there."""
        if self.alive.all():
            return [(0, self.m)]
        ends = np.flatnonzero(np.diff(np.concatenate([[False], self.alive, [False]]).astype(np.int8)))
        return list(zip(ends[::2].tolist(), ends[1::2].tolist(), strict=True))

    def erode(self, dead: NDArray[np.bool_]) -> None:
        """Take elements (m,) away: they have no volume, and nothing of theirs changes any more."""
        if dead.any():
            self._keep(self.alive & ~dead)

    def _keep(self, alive: NDArray[np.bool_]) -> None:
        if self.alive.all():
            self._whole = self.wJ0.copy()
        self.alive = alive
        self.wJ0[...] = np.where(alive[:, None], self._whole, 0.0)
        self.chunks = self._cut()
        self._share_history()

    def points(self) -> Points:
        """All integration points of the block as one batch (views)."""
        pts = Points(self.F.reshape(-1, 3, 3), self.J.reshape(-1), self.Xg, np.repeat(np.arange(self.m), self.g))
        pts.Q, pts.old, pts.new = self._axes(), self.old, self.new
        pts.extra = dict(self.extra)
        return pts

    @property
    def geometry(self) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """What kernels take: dN, inverse Jacobians and weights of the reference, F, J."""
        return self.dN, self.iJ0, self.wJ0, self.F, self.J

    def at_rest(self) -> Points:
        """All integration points, undeformed."""
        q = self.m * self.g
        pts = Points(np.tile(np.eye(3), (q, 1, 1)), np.ones(q), self.Xg, np.repeat(np.arange(self.m), self.g))
        pts.Q, pts.old, pts.new = self._axes(), self.old, self.new.copy()
        pts.extra = dict(self.extra)
        return pts

    def pieces(self, c: Chunk) -> Iterator[tuple[int, int, slice, slice]]:
        """Parts lo:hi of a chunk whose tangents stay in the cache, and their elements and points within the chunk."""
        size = max(8, CACHE // (8 * 3 * self.g * 7 * self.n))
        for lo in range(c.lo, c.hi, size):
            hi = min(lo + size, c.hi)
            yield lo, hi, slice(lo - c.lo, hi - c.lo), slice((lo - c.lo) * self.g, (hi - c.lo) * self.g)

    def set_history(self, old: Floats) -> None:
        """Take ``old`` (m g, h) as the history of the last converged state."""
        self.old, self.new = old, old.copy()
        self._share_history()

    def _share_history(self) -> None:
        """Chunks look at their parts of the histories."""
        for c in self.chunks:
            q = slice(c.lo * self.g, c.hi * self.g)
            c.points.old, c.points.new = self.old[q], self.new[q]

    def named(self, e: PoreCollapse) -> ElementFailure:
        """Which element of which part a law failed in."""
        return ElementFailure(f"element {self.block.ids[e.element]} of part {self.block.name!r}: {e}")

    # ---- update -----------------------------------------------------------------------------------
    def update(self, c: Chunk, state: State, u: Floats, drive: list[Any] | None = None) -> None:
        """Kinematics and stresses of a chunk at displacements u (node, 3). Raises NegativeJacobian."""
        if self.deforms:
            bad = solid.kinematics(c.lo, c.hi, u, self.conn, self.dN, self.iJ0, self.F, self.J)
            if bad >= 0:
                raise NegativeJacobian(int(self.block.ids[bad]), self.block.name)
        try:
            self.physics.update(c, state, drive or [])
        except PoreCollapse as e:
            raise self.named(e) from None

    def deform(self, u: Floats, F: Floats, J: Floats) -> None:
        """F (m, g, 3, 3) and J (m, g) of all elements at displacements u (node, 3)."""
        solid.kinematics(0, self.m, u, self.conn, self.dN, self.iJ0, F, J)

    # ---- steps ------------------------------------------------------------------------------------
    def begin_step(self, state: State) -> None:
        """The present state becomes the last converged one; memory is made ready for a step."""
        self.physics.begin_step(state)
        if self.new.shape[1]:
            self.old[:] = self.new
            if not self._grows:
                return
            pts = self.points()
            pts.t, pts.dt = state.time, state.dt
            self.set_history(history.begin(self.block.solid, pts))

    def snapshot(self) -> dict[str, Any]:
        """What a failed step must give back."""
        own = {"J": self.J.copy(), "F": self.F.copy(), "history": self.new.copy(), "alive": self.alive}
        return own | {"room": history.widths(self.block.solid)} | self.physics.snapshot()

    def restore(self, saved: dict[str, Any]) -> None:
        self.J[...], self.F[...] = saved["J"], saved["F"]
        if not np.array_equal(saved["alive"], self.alive):
            self._keep(saved["alive"])
        self.physics.restore(saved)
        history.take_widths(self.block.solid, saved["room"])
        self.set_history(saved["history"].copy())

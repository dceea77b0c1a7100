"""Elements that are taken away where they fail: after each solved step those that a criterion selects, the step then
solved once more without them. FEBio User Manual, "Mesh adaptor", erosion.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .criteria import Criterion, behind, selected
from .group import Impossible
from .order import introsorted
from .pattern import FREE, INACTIVE

if TYPE_CHECKING:
    from .contact.surface import Facets
    from .group import Group
    from .system import System

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bare = tuple[str, list[int], tuple[int, int]]  # type of a facet, its nodes, block and element behind it


@dataclass(eq=False)
class Erosion:
    """``rounds``: most times in a step (-1: any number); ``most``: elements at a time (0: any number), those first
    that have the largest values (``order`` 1), the least (2), or that come first (0); ``islands``: what hangs on
    nothing goes as well; ``elements`` by block, None: all."""

    criterion: Criterion
    rounds: int = -1
    most: int = 0
    order: int = 0
    islands: bool = False
    elements: dict[str, Ints] | None = None
    grow: bool = False  # surfaces in contact go on on what lies bare
    changed: list[Any] = field(default_factory=list, init=False, repr=False)  # surfaces before the step, by contact

    def apply(self, done: int, system: System) -> bool:
        """Take elements away after ``done`` rounds in the present step. Were there any?"""
        if 0 <= self.rounds <= done:
            return False
        chosen = self._chosen(system)
        if not chosen.any():
            return False
        for g, dead in zip(system.groups, np.split(chosen, np.cumsum([g.m for g in system.groups])[:-1]), strict=True):
            g.erode(dead)
        if self.islands:
            remove_islands(system)
        self.changed += erode_surfaces(system, self.grow)
        return True

    def begin(self) -> None:
        """A time step begins."""
        self.changed.clear()

    def give_back(self, system: System) -> None:
        """Surfaces are what they were before the step."""
        for contact, *surfaces in reversed(self.changed):
            contact.primary, contact.secondary, contact.eroded = surfaces
            contact.begin(system.state, system.groups)
        self.changed.clear()

    def _chosen(self, system: System) -> NDArray[np.bool_]:
        """The elements to take, of all groups one after another."""
        chosen, value = selected(self.criterion, self.elements, system)
        rows = np.flatnonzero(chosen)
        if self.most > 0:
            if self.order:
                rows = rows[introsorted(value[rows].tolist(), self.order == 1)]
            rows = rows[: self.most]
        out = np.zeros(len(chosen), bool)
        out[rows] = True
        return out


def remove_islands(system: System) -> None:
    """Take away what has no node that is held, prescribed or led."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    n = len(system.state.d)
    alive = [g.conn[g.alive] for g in system.groups]
    a = np.concatenate([np.repeat(c[:, 0], c.shape[1]) for c in alive])
    b = np.concatenate([c.ravel() for c in alive])
    _, label = connected_components(coo_array((np.ones(len(a)), (a, b)), (n, n)), directed=False)
    kind = system.eqs.kind[:, system.layout.displacement]
    held = np.isin(label, label[((kind != FREE) & (kind != INACTIVE)).any(axis=1)])
    for g in system.groups:
        g.erode(g.alive & ~held[g.conn[:, 0]])


def erode_surfaces(system: System, grow: bool) -> list[tuple[Any, Facets, Facets, bool]]:
    """Take facets of eroded elements off surfaces in contact; ``grow``: what lies bare behind them comes instead.

    Returns the contacts that changed, with the surfaces that they had. Raises Impossible.
    """
    before: list[tuple[Any, Facets, Facets, bool]] = []
    for contact in system.contacts:
        old = contact.primary, contact.secondary
        new = [left(f, system.groups, grow) for f in old]
        if new[0] is old[0] and new[1] is old[1]:
            continue
        if not contact.erodes or contact.laugon:
            raise Impossible(f"elements under a contact ({type(contact).__name__}) erode, which febkit does not follow")
        before.append((contact, *old, contact.eroded))
        contact.primary, contact.secondary, contact.eroded = *new, True
        contact.begin(system.state, system.groups)
    for load in system.loads:
        for patch in getattr(load, "surface", ()):
            _refuse_loaded(patch.conn, system.groups)
    return before


def left(f: Facets, groups: list[Group], grow: bool) -> Facets:
    """A surface without the facets of eroded elements; itself where it has none."""
    dead = {k: _dead(owner, groups) for k, owner in f.owner.items()}
    if not any(d.any() for d in dead.values()):
        return f
    conn, owner = ({k: v[~dead[k]] for k, v in part.items()} for part in (f.conn, f.owner))
    modulus = {k: v[~dead[k]] for k, v in f.modulus.items()}
    new = _grown(f, dead, groups) if grow else []
    for kind, nodes, own in new:
        conn[kind] = np.vstack([conn.get(kind, np.zeros((0, len(nodes)), np.int64)), [nodes]])
        owner[kind] = np.vstack([owner.get(kind, np.zeros((0, 2), np.int64)), [own]])
        modulus |= {kind: np.append(modulus[kind], 0.0)} if kind in modulus else {}
    return replace(f, conn=conn, owner=owner, modulus=modulus)


def _grown(f: Facets, dead: dict[str, NDArray[np.bool_]], groups: list[Group]) -> list[Bare]:
    """What lies bare behind the eroded elements of a surface."""
    gone: dict[tuple[int, int], set[int]] = {}
    for kind, d in dead.items():
        for (b, e), nodes in zip(f.owner[kind][d].tolist(), f.conn[kind][d].tolist(), strict=True):
            gone.setdefault((b, e), set(nodes))
    return [bare for (b, e), facet in gone.items() for bare in _bare(groups, b, e) if set(bare[1]) != facet]


def _dead(owner: Ints, groups: list[Group]) -> NDArray[np.bool_]:
    """Is the element behind each facet gone?"""
    return np.array([b >= 0 and not groups[b].alive[e] for b, e in owner.tolist()], bool)


def _bare(groups: list[Group], b: int, e: int) -> Iterator[Bare]:
    """Facets of elements that touch element e of block b, seen from there."""
    g = groups[b]
    for kind, local in g.element.facets:
        nodes = g.conn[e, list(local)].astype(np.int64)
        for other, h in enumerate(groups):
            for k in np.flatnonzero(behind(h, nodes) & h.alive):
                yield kind, nodes[::-1].tolist(), (other, int(k))


def _refuse_loaded(conn: Ints, groups: list[Group]) -> None:
    """Raise Impossible where a loaded facet has lost its element."""
    for g in groups:
        gone = g.conn[~g.alive]
        for facet in conn[np.isin(conn, gone).all(axis=1)]:
            own = behind(g, facet)
            if own.any() and not (own & g.alive).any():
                which = f"element {g.block.ids[int(np.argmax(own))]} of part {g.block.name!r}"
                raise Impossible(f"{which} erodes under a load on its facet, which febkit does not follow")

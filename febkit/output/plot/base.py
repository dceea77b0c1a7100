"""What a plot variable is: a function of a part of the model in a state, by the name that FEBio gives its values.

A file of this package defines such functions and ends in ``register("FEBio's name", function)`` for each. Where FEBio
stores a variable (:mod:`febkit.results.variables`) says what its function is given:

| section | given | returns |
|---|---|---|
| node | a :class:`View` | (node[, component]) |
| domain | a :class:`Part` | (element, ...), (element, node, ...), (node, ...) or (...), by the variable's format |
| surface | a :class:`Face` | (facet, ...), (facet, node, ...) or (...) |
| global | a :class:`View` | (...) |

and None where there is no such thing. A variable that may be told more (``type="damage['solid[1]']"``) takes what
stands in the brackets as a second argument. Values at integration points (element, point, ...) are made variables by
:func:`mean`, :func:`at_nodes`, :func:`integral`. What several variables of a state need is evaluated once
(:func:`shared`).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, wraps
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from febkit.solver.points import VOIGT

if TYPE_CHECKING:
    from febkit.model import Model, Surface
    from febkit.results.xplt.records import PlotDomain, PlotMesh, PlotSurface
    from febkit.solver.group import Group
    from febkit.solver.points import Points
    from febkit.solver.run import Run
    from febkit.solver.state import State

Floats = NDArray[np.float64]
Give = Callable[..., "Floats | None"]
AtPoints = Callable[..., "Floats | None"]
T = TypeVar("T")
FULL = [0, 3, 5, 3, 1, 4, 5, 4, 2]  # places of xx xy xz yx yy yz zx zy zz among xx yy zz xy yz xz

table: dict[str, Give] = {}
told: set[str] = set()  # those that take what stands in brackets


def register(name: str, give: Give, more: bool = False) -> None:
    """Make a variable known by FEBio's name; ``more``: it takes what stands in brackets."""
    table[name] = give
    if more:
        told.add(name)


# ---- what there is in a state -------------------------------------------------------------------------
class View:
    """A state of a run. ``kept`` holds what variables share, until the next state."""

    def __init__(self, run: Run, model: Model, mesh: PlotMesh) -> None:
        self.run, self.model, self.mesh = run, model, mesh
        self.kept: dict[object, Any] = {}
        groups = {g.block.name: g for g in run.groups}
        self.parts = [Part(self, d.block, d.kind, d.material, mesh.domains[k], groups.get(d.block))
                      for k, d in enumerate(model.domains)]  # fmt: skip
        springs = mesh.domains[len(self.parts) :]
        self.parts += [Part(self, d.name or "", "discrete", "", d, None) for d in springs]
        self.faces = [Face(self, model.mesh.surfaces[s.name], s) for s in mesh.surfaces]

    @property
    def state(self) -> State:
        return self.run.state

    def renew(self) -> None:
        """The state has changed."""
        self.kept.clear()


class Part:
    """The elements of a domain: its ``group``, None where it is rigid, or of springs.

    ``kind`` is "solid", "shell" or "discrete", ``material`` the name of its material.
    """

    def __init__(
        self, view: View, name: str, kind: str, material: str, mesh: PlotDomain, group: Group | None
    ) -> None:  # fmt: skip
        self.view, self.name, self.kind, self.material = view, name, kind, material
        self.mesh, self.group = mesh, group

    @property
    def run(self) -> Run:
        return self.view.run

    @property
    def state(self) -> State:
        return self.view.run.state

    @property
    def shell(self) -> bool:
        return self.kind == "shell"

    @property
    def g(self) -> Group:
        """The group of a part that has one."""
        assert self.group is not None
        return self.group

    def at_points(self, name: str) -> Floats | None:
        """What the physics offers under FEBio's name (m, g[, component]); None: nothing."""
        give = self.g.physics.outputs.get(name)
        return None if give is None else kept(self, name, lambda: give(self.g.physics))

    def points(self) -> Points:
        """All integration points at the present time, to ask laws; what they write of histories is not kept."""
        pts = self.g.points()
        pts.t, pts.dt = self.state.time, self.state.dt
        if pts.new is not None:
            pts.new = pts.new.copy()
        return pts

    def shaped(self, values: Floats) -> Floats:
        """Values (n | 1, ...) of all points as (m, g, ...)."""
        g = self.g
        return np.broadcast_to(values, (g.m * g.g, *np.shape(values)[1:])).reshape(g.m, g.g, *np.shape(values)[1:])

    def interpolated(self, nodal: Floats) -> Floats:
        """A nodal array (node, k) at the points (m, g, k)."""
        return np.asarray(np.einsum("ga,eak->egk", self.g.N, nodal[self.g.conn]))


class Face:
    """A surface of the mesh; ``kinds`` are its facets by type, ("quad4", facets (f, n)), in the order of its rows."""

    def __init__(self, view: View, surface: Surface, mesh: PlotSurface) -> None:
        self.view, self.surface, self.mesh = view, surface, mesh
        self.kinds = [(kind, np.asarray(c, np.int64)) for kind, c in surface.facets.items() if len(c)]

    @property
    def name(self) -> str:
        return self.surface.name

    @property
    def state(self) -> State:
        return self.view.run.state

    @cached_property
    def nodes(self) -> NDArray[np.integer]:
        return self.mesh.nodes()

    @cached_property
    def width(self) -> int:
        """Nodes of the largest facet."""
        return max((c.shape[1] for _, c in self.kinds), default=0)

    @cached_property
    def behind(self) -> list[list[tuple[Part, int] | None]]:
        """The part and element behind each facet, type by type: the first with that face, None where there is none."""
        from febkit.solver import elements

        at: dict[tuple[int, ...], tuple[Part, int]] = {}
        own = np.zeros(int(self.nodes.max(initial=-1)) + 1, bool)
        own[self.nodes] = True
        for part in self.view.parts:
            if part.group is None:
                continue
            conn = np.asarray(part.mesh.conn)
            mine = np.flatnonzero((own[np.minimum(conn, len(own) - 1)] & (conn < len(own))).sum(axis=1) >= 3)
            faces = ((None, tuple(range(conn.shape[1]))),) if part.shell else part.group.element.facets
            for kind, local in faces:
                corners = elements.shape(kind or part.mesh.type).corners
                for e in mine:
                    at.setdefault(tuple(sorted(conn[e, list(local[:corners])].tolist())), (part, int(e)))
        out = []
        for kind, c in self.kinds:
            corners = elements.shape(kind).corners
            out.append([at.get(tuple(sorted(row))) for row in c[:, :corners].tolist()])
        return out


# ---- values of a state that several variables need ------------------------------------------------------
def kept(part: Part | Face | View, key: object, make: Callable[[], T]) -> T:
    """What ``make`` gives for a part, once a state."""
    own = part.kept if isinstance(part, View) else part.view.kept
    at = id(part), key
    if at not in own:
        own[at] = make()
    return own[at]  # type: ignore[no-any-return]


def shared(function: Callable[[Any], T]) -> Callable[[Any], T]:
    """A function of a part that is evaluated once a state."""

    @wraps(function)
    def once(part: Any) -> T:
        return kept(part, function, lambda: function(part))

    return once


# ---- how values at integration points are written --------------------------------------------------------
def _of_groups(points: AtPoints, write: Callable[[Part, Floats], Floats], lines: bool = False) -> Give:
    def give(part: Part, *more: Any) -> Floats | None:
        if part.group is None or (part.kind == "beam" and not lines):
            return None
        values = points(part, *more)
        return None if values is None else write(part, values)

    give.points = points  # type: ignore[attr-defined]
    return give


def mean(points: AtPoints, lines: bool = False) -> Give:
    """The mean over the points of each element, as FEBio writes element data (element, ...); ``lines``: beams and
    trusses have it too."""
    return _of_groups(points, lambda part, v: v.mean(axis=1), lines)


def at_nodes(points: AtPoints) -> Give:
    """Extrapolated to the nodes of each element (element, node, ...)."""
    return _of_groups(points, lambda part, v: np.einsum("ng,eg...->en...", part.g.element.extrapolation, v))


def integral(points: AtPoints) -> Give:
    """The integral over the reference volume of each element (element, ...)."""
    return _of_groups(points, lambda part, v: np.einsum("eg,eg...->e...", part.g.wJ0, v))


def total(points: AtPoints) -> Give:
    """The integral over the reference volume of a part (...); of solids alone, as FEBio has it."""

    def solids(part: Part) -> Floats | None:
        return None if part.shell else points(part)

    return _of_groups(solids, lambda part, v: np.einsum("eg,eg...->...", part.g.wJ0, v))


# ---- tensors -----------------------------------------------------------------------------------------
def voigt(T: Floats) -> Floats:
    """Symmetric tensors (..., 3, 3) as (..., 6): xx yy zz xy yz xz."""
    return np.stack([T[..., i, j] for i, j in VOIGT], axis=-1)


def full(v: Floats) -> Floats:
    """Symmetric tensors (..., 6) as (..., 3, 3)."""
    return v[..., FULL].reshape(*v.shape[:-1], 3, 3)


def of_solids(points: AtPoints) -> AtPoints:
    """Nothing for shells."""
    return lambda part, *more: None if part.shell else points(part, *more)

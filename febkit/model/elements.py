"""Every element type FEBio has, in one table: shape, nodes, facets, and its names and numbers in other formats.

Nodes and facets are numbered as in FEBio's User Manual; the solver's own shapes (``solver/elements``) are held against
this table by a test.
"""

from __future__ import annotations

from febkit.record import value_record

Facets = tuple[tuple[str, tuple[int, ...]], ...]

DIMENSIONS = {"hex": 3, "tet": 3, "penta": 3, "pyra": 3, "quad": 2, "tri": 2, "line": 1, "truss": 1}
CORNERS = {"hex": 8, "tet": 4, "penta": 6, "pyra": 5, "quad": 4, "tri": 3, "line": 2, "truss": 2}
# outward, corners alone
FACES: dict[str, Facets] = {
    "hex": (("quad", (0, 1, 5, 4)), ("quad", (1, 2, 6, 5)), ("quad", (2, 3, 7, 6)), ("quad", (3, 0, 4, 7)),
            ("quad", (0, 3, 2, 1)), ("quad", (4, 5, 6, 7))),
    "tet": (("tri", (0, 1, 3)), ("tri", (1, 2, 3)), ("tri", (2, 0, 3)), ("tri", (2, 1, 0))),
    "penta": (("quad", (0, 1, 4, 3)), ("quad", (1, 2, 5, 4)), ("quad", (0, 3, 5, 2)), ("tri", (0, 2, 1)),
              ("tri", (3, 4, 5))),
    "pyra": (("tri", (0, 1, 4)), ("tri", (1, 2, 4)), ("tri", (2, 3, 4)), ("tri", (3, 0, 4)), ("quad", (3, 2, 1, 0))),
}  # fmt: skip
# edges whose middles are the nodes after the corners, in their order
EDGES: dict[str, tuple[tuple[int, int], ...]] = {
    "hex": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    "tet": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "penta": ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    "pyra": ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)),
}  # fmt: skip
# nodes in the middles of the facets, in the facets' order
MIDDLES = {"hex27": (20, 21, 22, 23, 24, 25), "tet15": (11, 12, 13, 10)}
# facets with two nodes on each edge
CUBIC: dict[str, Facets] = {
    "tet20": (("tri10", (0, 1, 3, 4, 5, 12, 13, 10, 11, 16)), ("tri10", (1, 2, 3, 6, 7, 14, 15, 12, 13, 17)),
              ("tri10", (2, 0, 3, 9, 8, 10, 11, 14, 15, 18)), ("tri10", (2, 1, 0, 7, 6, 5, 4, 9, 8, 19))),
}  # fmt: skip


@value_record
class ElementType:
    """``code``: its number in plotfiles, None where they cannot hold it; ``meshio``: the name there of the type that
    holds its first ``kept`` nodes (VTK has the same types)."""

    name: str
    shape: str
    nodes: int
    code: int | None = None
    meshio: str = ""
    kept: int = 0

    @property
    def dim(self) -> int:
        return DIMENSIONS[self.shape]

    @property
    def corners(self) -> int:
        return CORNERS[self.shape]

    @property
    def whole(self) -> bool:
        """Does meshio's type hold all its nodes?"""
        return bool(self.meshio) and self.kept == self.nodes

    @property
    def facets(self) -> Facets:
        """Facets as (type, local nodes): corners, middles of the edges, the facet's own middle node."""
        if self.name in CUBIC:
            return CUBIC[self.name]
        edges = EDGES.get(self.shape, ())
        if self.nodes < self.corners + len(edges):  # linear, maybe with a node inside
            edges = ()
        out = []
        for k, (kind, loop) in enumerate(FACES.get(self.shape, ())):
            between = zip(loop, (*loop[1:], loop[0]))
            nodes = loop
            if edges:
                nodes += tuple(self.corners + _edge(edges, a, b) for a, b in between)
            if self.name in MIDDLES:
                nodes += (MIDDLES[self.name][k],)
            out.append((f"{kind}{len(nodes)}", nodes))
        return tuple(out)


def _edge(edges: tuple[tuple[int, int], ...], a: int, b: int) -> int:
    return next(i for i, e in enumerate(edges) if set(e) == {a, b})


def _table(text: str) -> dict[str, ElementType]:
    out = {}
    for line in text.split("\n"):
        words = line.split()
        if words:
            name, code, *other = words
            shape = name.rstrip("0123456789")
            nodes = int(name[len(shape) :])
            meshio, kept = (other[0].partition(":")[0], int(other[0].partition(":")[2] or nodes)) if other else ("", 0)
            out[name] = ElementType(name, shape, nodes, None if code == "-" else int(code), meshio, kept)
    return out


#: name -> its row: name, number in plotfiles, meshio's type[:nodes it holds]
ELEMENTS: dict[str, ElementType] = _table("""
    hex8     0 hexahedron
    penta6   1 wedge
    tet4     2 tetra
    quad4    3 quad
    tri3     4 triangle
    line2    5 line
    hex20    6 hexahedron20
    tet10    7 tetra10
    tet15    8 tetra10:10
    hex27    9 hexahedron27
    tri6    10 triangle6
    quad8   11 quad8
    quad9   12 quad9
    penta15 13 wedge15
    tet20   14 tetra:4
    tri10   15 triangle:3
    pyra5   16 pyramid
    tet5    17 tetra:4
    pyra13  18 pyramid13
    line3   19 line3
    tri7     - triangle6:6
    truss2   -
""")


ALIASES = {"truss2": "line2"}  #: types under another name, by which plotfiles and meshio know them


def of_dimension(dim: int) -> tuple[str, ...]:
    """Names of the types of solids (3), facets (2) or lines (1)."""
    return tuple(n for n, e in ELEMENTS.items() if e.dim == dim)


def domain(name: str) -> str:
    """What kind of domain elements of a type make: "solid", "shell" (of facets) or "beam" (of lines)."""
    return {3: "solid", 2: "shell"}.get(ELEMENTS[name].dim, "beam")


def corners(name: str) -> int:
    """Corner nodes of an element type; they come first."""
    return ELEMENTS[name].corners

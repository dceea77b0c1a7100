"""FEBio's element types and meshio's, from the table of all elements."""

from __future__ import annotations

from febkit.model.elements import ALIASES, ELEMENTS

_PLOTTED = {n: e for n, e in ELEMENTS.items() if e.code is not None}
MESHIO: dict[str, str] = {n: ELEMENTS[ALIASES.get(n, n)].meshio for n in (*_PLOTTED, *ALIASES)}  # FEBio -> meshio
KEPT: dict[str, int] = {n: e.kept for n, e in _PLOTTED.items() if not e.whole}  # nodes that meshio's type can hold

# FEBio numbers the face nodes of a 27-node hexahedron -y +x +y -x -z +z, VTK -x +x -y +y -z +z
ORDER: dict[str, list[int]] = {"hex27": [*range(20), 23, 21, 20, 22, 24, 25, 26]}
INVERSE: dict[str, list[int]] = {f: [order.index(i) for i in range(len(order))] for f, order in ORDER.items()}

FEBIO: dict[str, str] = {e.meshio: n for n, e in _PLOTTED.items() if e.whole}  # meshio -> FEBio
SURFACE_TYPES: dict[int, str] = {e.nodes: n for n, e in _PLOTTED.items() if e.dim == 2 and e.whole}

SOLIDS = frozenset(n for n, e in _PLOTTED.items() if e.dim == 3)
FACETS = frozenset(n for n, e in _PLOTTED.items() if e.dim == 2)
LINES = frozenset(n for n, e in _PLOTTED.items() if e.dim == 1)

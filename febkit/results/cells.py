"""FEBio's element types and meshio's."""

from __future__ import annotations

MESHIO: dict[str, str] = {  # FEBio -> meshio
    "hex8": "hexahedron", "penta6": "wedge", "tet4": "tetra", "quad4": "quad", "tri3": "triangle",
    "line2": "line", "hex20": "hexahedron20", "tet10": "tetra10", "tet15": "tetra10", "hex27": "hexahedron27",
    "tri6": "triangle6", "quad8": "quad8", "quad9": "quad9", "penta15": "wedge15", "tet20": "tetra",
    "tri10": "triangle", "pyra5": "pyramid", "tet5": "tetra", "pyra13": "pyramid13", "line3": "line3",
}

KEPT: dict[str, int] = {"tet15": 10, "tet20": 4, "tri10": 3, "tet5": 4}  # nodes that meshio's type can hold

# FEBio numbers the face nodes of a 27-node hexahedron -y +x +y -x -z +z, VTK -x +x -y +y -z +z
ORDER: dict[str, list[int]] = {"hex27": [*range(20), 23, 21, 20, 22, 24, 25, 26]}

FEBIO: dict[str, str] = {m: f for f, m in reversed(MESHIO.items()) if f not in KEPT}  # meshio -> FEBio

INVERSE: dict[str, list[int]] = {
    f: [order.index(i) for i in range(len(order))] for f, order in ORDER.items()
}

SURFACE_TYPES: dict[int, str] = {3: "tri3", 4: "quad4", 6: "tri6", 8: "quad8", 9: "quad9"}

SOLIDS = frozenset({"hex8", "penta6", "tet4", "hex20", "tet10", "tet15", "hex27", "penta15", "tet20", "pyra5",
                    "tet5", "pyra13"})
FACETS = frozenset({"quad4", "tri3", "tri6", "quad8", "quad9", "tri10"})
LINES = frozenset({"line2", "line3"})

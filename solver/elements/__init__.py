"""Elements by name. One file per element; a file is read when its element is first asked for.

The first rule of an element is FEBio's default in solid and biphasic domains (facets: in surface loads).
"""

from __future__ import annotations

from functools import cache
from importlib import import_module

from .base import Element, Shape

_shapes: dict[str, Shape] = {}

VOLUMES = ("hex8", "tet4", "penta6", "pyra5", "hex20", "tet10", "hex27", "tet15", "penta15", "pyra13", "tet5",
           "tet20")  # fmt: skip
FACETS = ("quad4", "tri3", "quad8", "tri6", "quad9", "tri7", "tri10")
LINES = ("line2", "line3")
SHELLS = ("shell_quad4", "shell_quad8", "shell_tri3", "shell_tri6")


def register(shape: Shape) -> None:
    """Make a shape known by its name; the last line of an element's file."""
    _shapes[shape.name] = shape


def known(name: str) -> bool:
    """True where there is an element of this name."""
    return name in VOLUMES + FACETS + LINES + SHELLS


def shape(name: str) -> Shape:
    """The table of an element, read from its file when first asked for."""
    if name not in _shapes:
        if not known(name):
            raise KeyError(f"no element is called {name}")
        import_module(f"{__name__}.{name}")
    return _shapes[name]


@cache
def get(name: str, rule: str | None = None) -> Element:
    """The element ``name`` ("hex8") with an integration rule ("G8"), FEBio's default where none is named.

    Raises KeyError where there is no such element or rule.
    """
    return shape(name).element(rule)


def from_spec(spec: str) -> tuple[str, str, dict[str, str]]:
    """FEBio's ``elem_type`` such as "TET10G4_S3": element, its rule, and rules of facets changed by it."""
    body, _, surface = spec.partition("_S")
    name, _, number = body.partition("G")
    facet = {"tet10": "tri6", "tet15": "tri7"}.get(name.lower())
    return name.lower(), f"G{number}", {facet: f"G{surface}"} if surface and facet else {}

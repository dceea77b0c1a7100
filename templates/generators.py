"""Mesh generators that a template file can name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from febkit.model import InputError

from .parts import Generated, Parts
from .quality import jacobians, judge
from .sets import membranes, named_mesh

ROLES = {"tissue": "ecm", "ecm": "ecm", "pcm": "pcm", "cell": "chondrocyte", "membrane": "membrane"}


def _finished(made: Parts, more: Mapping[str, Any]) -> Generated:
    """The model's mesh, the names templates may use, and the report of its quality."""
    quality = judge(made.X, list(made.parts.values()))
    if quality.jacobian_min <= 0:
        inside_out = [name for name, p in made.parts.items() if jacobians(made.X, *p).min() <= 0]
        raise InputError(f"the mesh has elements turned inside out, in {', '.join(inside_out)}: the cells leave too "
                         "little room around them (raise gap or room, or give a finer background, n), or lie too far "
                         "off the middle of their PCM (reduce shift)")
    parts = []
    for name in made.parts:
        role = ROLES.get(name.partition("_")[0])
        if role is None:
            raise InputError(f"part '{name}': templates know parts named tissue, ecm, pcm_... and cell_...; "
                             "rename it with part_names")
        parts.append([name, role])
    facts: dict[str, Any] = {"parts": parts, "roles": sorted({r for _, r in parts})}
    facts["shells"] = [[name, ROLES["membrane"]] for name in made.shells]
    facts |= {"low": made.X.min(axis=0).tolist(), "high": made.X.max(axis=0).tolist()}
    report = {"nodes": len(made.X), "elements": made.elements, "quality": quality} | dict(more)
    return Generated(named_mesh(made), facts, report)


def _tissue(p: dict[str, Any]) -> Generated:
    from .tissue_cube import tissue_cube

    return _from_file(p) if p.get("mesh_file") else _finished(tissue_cube(p), {})


def _given(p: Mapping[str, Any]) -> bool:
    """Whether the mesh is the user's. Raises InputError for types of elements that no generated one has."""
    given = bool(p.get("mesh_file") or p.get("surfaces"))
    if not given:
        _unmeshed(p, "the generated mesh is of hexahedra")
    return given


def _unmeshed(p: Mapping[str, Any], why: str) -> None:
    if p.get("tets", "tet4") != "tet4":
        raise InputError(f'tets = "{p["tets"]}" is for images (mesh_file = "labels.tif") and surfaces: {why}')


def _enclosed(made: Parts, p: Mapping[str, Any]) -> Parts:
    """The mesh with membranes on its cells, where they have a thickness."""
    if not p.get("membrane_thickness"):
        return made
    if p.get("physics", "biphasic") != "biphasic":
        raise InputError("membranes are biphasic shells: set membrane_thickness = 0, or physics to biphasic")
    return replace(made, shells=membranes(made))


def _cell(p: dict[str, Any]) -> Generated:
    from .cell_cube import cell_cube, volume_report

    if _given(p):
        return _from_file(p)
    cube = cell_cube(p)
    more: dict[str, Any] = {"cells": sum(len(c.cells) for c in cube.cells), "centres": cube.places.centres}
    return _finished(_enclosed(cube.mesh, p), more | volume_report(cube.mesh, cube.cells, cube.edge**3))


def _embedded(p: dict[str, Any]) -> Generated:
    from .cell_cube import volume_report
    from .embedded_cube import embedded_cube

    if _given(p):
        return _from_file(p)
    whole = embedded_cube(p)
    cube = whole.inner
    more: dict[str, Any] = {"cells": sum(len(c.cells) for c in cube.cells), "centres": cube.places.centres,
                            "nodes of the cell cube": len(cube.mesh.X)}
    return _finished(_enclosed(whole.mesh, p), more | volume_report(cube.mesh, cube.cells, cube.edge**3))


def _chondron(p: dict[str, Any]) -> Generated:
    from .chondron_block import chondron_block

    if _given(p):
        return _from_file(p)
    block = chondron_block(p)
    return _finished(_enclosed(block.mesh, p), block.report())


def _cartilage(p: dict[str, Any]) -> Generated:
    from .cartilage_layer import cartilage

    return cartilage(p)


def _from_file(p: dict[str, Any]) -> Generated:
    from . import segmented
    from .user_mesh import named_image, user_mesh

    file, names, scale = p.get("mesh_file", ""), p.get("part_names", {}), float(p.get("scale", 1.0))
    wedges = (int(p["wedges"]), float(p["wedge_share"])) if p.get("tets") == "hybrid" else None
    if p.get("surfaces"):
        made = segmented.from_surfaces(p["surfaces"], scale, wedges)
    elif not file:
        raise InputError("set mesh_file to the mesh to read (any format of meshio)")
    elif file.lower().endswith(segmented.IMAGES):
        made = named_image(file, names, p.get("voxel", []), int(p.get("smoothing", 10)), wedges)
    else:
        _unmeshed(p, f"{file} is a mesh, whose elements are taken as they are")
        made = user_mesh(file, names, p.get("part_array", ""), scale)
        return _finished(_enclosed(made, p), {"read from": file})
    made = segmented.quadratic(made) if p.get("tets") == "tet10" else made
    return _finished(_enclosed(made, p), {"made of": file or ", ".join(p["surfaces"].values())})


GENERATORS: dict[str, Callable[[dict[str, Any]], Generated]] = {
    "tissue": _tissue, "cell": _cell, "embedded": _embedded, "cartilage": _cartilage, "chondron": _chondron,
    "file": _from_file,
}

"""A layer of cartilage: a plan grown over depth, flat or bent onto a sphere, cut into zones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats, Ints

from .lattice import spaced
from .plan import CORE, Plan, disc, rectangle


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """Nodes (node, 3), the articular surface at z = ``thickness`` and the bone at z = 0 (on the axis, where bent).

    ``parts``: name -> hexahedra (element, 8), one part for each zone or for each layer of elements;
    ``zone``: which of the ``zones`` (their names, from the surface down) a part is of. ``depth`` and ``frame``: of each
    part's elements, the normalised depth of the centre (element,) and the local axes (element, 3, 3) with the third out
    of the articular surface. ``surfaces``: name -> quads, outward.
    """

    X: Floats
    parts: Mapping[str, Ints]
    zone: Mapping[str, int]
    zones: tuple[str, ...]
    depth: Mapping[str, Floats]
    frame: Mapping[str, Floats]
    surfaces: Mapping[str, Ints]
    thickness: float
    flat: bool


def layer(p: Mapping[str, Any], each: bool) -> Layer:
    """Build the layer from the template's parameters (see templates/cartilage/template.toml).

    ``each``: a part for each layer of elements instead of one for each zone.
    """
    shape, H = str(p["shape"]), float(p["thickness"])
    if shape == "column":
        plan = rectangle((float(p["width"][0]), float(p["width"][1])), (int(p["across"][0]), int(p["across"][1])))
    else:
        sizes = float(p["radius"]), int(p["core"]), int(p["rings"])
        plan = disc(*sizes, bool(p["quarter"]), float(p["ring_grading"]), _share(p))
    zones = _bounds(p["zones"])
    depths = _planes(int(p["layers"]), float(p["grading"]), zones)
    bend = float(p["curvature"]) if shape == "curved" else 0.0
    return _grown(plan, depths, _rows(depths, zones, each), zones, H, bend)


def _share(p: Mapping[str, Any]) -> float:
    """Share of the disc's radius that its core takes; under an indenter the core is no wider than that."""
    R, core = float(p["radius"]), float(p["core_radius"])
    if core >= 0.95 * R:
        raise InputError(f"core_radius ({core:g} mm) leaves no room for rings: at most 0.95 of the radius ({R:g} mm)")
    if core == 0.0:
        core = CORE * R if p["pressed_by"] == "plate" else min(CORE * R, float(p["indenter_radius"]))
    return core / R


def _bounds(zones: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    """Range of depth of each zone, from the depths at which they end."""
    if not zones:
        raise InputError("zones must name at least one zone and the depth at which it ends, such as {cartilage = 1.0}")
    last, out = 0.0, {}
    for name, end in zones.items():
        if isinstance(end, bool) or not isinstance(end, int | float) or not last < end <= 1.0:
            raise InputError(f"zones: {name} must end at a depth above {last:g} and at most 1, not {end!r}: name "
                             "the zones from the articular surface (0) to the bone (1)")
        out[name] = (last, float(end))
        last = float(end)
    if last != 1.0:
        raise InputError(f"zones: the last one, {list(zones)[-1]}, must end at depth 1 (the bone), not {last:g}")
    return out


def _planes(layers: int, grading: float, zones: Mapping[str, tuple[float, float]]) -> Floats:
    """Depths of the planes between the layers of elements: graded over the whole thickness, then drawn to the zones'
    ends."""
    even = spaced(0.0, 1.0, layers, grading)
    ends = [b for _, b in zones.values()]
    at = [0, *(int(np.abs(even - e).argmin()) for e in ends)]
    for (name, (a, b)), (i, j) in zip(zones.items(), pairwise(at), strict=True):
        if j <= i:
            raise InputError(f"layers = {layers}: the {name} zone, from depth {a:g} to {b:g}, has no layer of "
                             "elements of its own; take more layers, or another grading")
    return np.asarray(np.interp(even, even[at], [0.0, *ends]), float)


def _rows(depths: Floats, zones: Mapping[str, tuple[float, float]], each: bool) -> dict[str, tuple[int, Ints]]:
    """Part -> its zone's number and its layers of elements, counted from the surface; ``each``: a part for each
    layer."""
    middles = (depths[:-1] + depths[1:]) / 2.0
    out: dict[str, tuple[int, Ints]] = {}
    for number, (name, (a, b)) in enumerate(zones.items()):
        rows = np.flatnonzero((middles > a) & (middles < b))
        if each:
            out |= {f"{name}_{k}": (number, rows[k - 1:k]) for k in range(1, len(rows) + 1)}
        else:
            out[name] = (number, rows)
    return out


def _grown(plan: Plan, depths: Floats, rows: Mapping[str, tuple[int, Ints]], zones: Mapping[str, Any], H: float,
           bend: float) -> Layer:  # fmt: skip
    m = len(plan.x)
    X, normals = _bent(plan.x, depths, H, bend)
    middles = (depths[:-1] + depths[1:]) / 2.0
    axes = _frames(_unit(normals[plan.quads].mean(axis=1)))
    hexes, depth, frame = {}, {}, {}
    for name, (_, at) in rows.items():
        upper = (plan.quads[None] + m * at[:, None, None]).reshape(-1, 4)
        hexes[name] = np.concatenate([upper + m, upper], axis=1)
        depth[name] = np.repeat(middles[at], len(plan.quads))
        frame[name] = np.tile(axes, (len(at), 1, 1))
    zone = {name: number for name, (number, _) in rows.items()}
    return Layer(X, hexes, zone, tuple(zones), depth, frame, _surfaces(plan, len(depths)), H, bend == 0.0)


def _surfaces(plan: Plan, levels: int) -> dict[str, Ints]:
    """The articular surface, the bone, the sides together and each plane face of them."""
    m = len(plan.x)
    out = {"top": plan.quads, "bottom": plan.quads[:, ::-1] + m * (levels - 1)}
    for name, line in plan.lines.items():
        below = (line[None] + m * np.arange(1, levels)[:, None, None]).reshape(-1, 2)
        out[name] = np.concatenate([below, below[:, ::-1] - m], axis=1)
    out["sides"] = np.concatenate([out[n] for n in plan.lines if not n.endswith("_plane")])
    out.pop("rim", None)
    return out


def _bent(x: Floats, depths: Floats, H: float, R: float) -> tuple[Floats, Floats]:
    """Nodes (level by level from the articular surface down) and the outward normals (node of the plan, 3).

    A bent layer is as thick everywhere, along the normals of the articular surface, a sphere of radius R > 0 (convex)
    or -R (a hollow).
    """
    if R == 0.0:
        normals = np.tile([0.0, 0.0, 1.0], (len(x), 1))
        top = np.column_stack([x, np.full(len(x), H)])
    else:
        far = float(np.linalg.norm(x, axis=1).max())
        if far >= 0.95 * abs(R) or 0.0 < R <= H:
            raise InputError(f"curvature = {R:g} mm: the radius of the articular surface must be greater than that "
                             f"of the disc ({far:g} mm / 0.95) and, where convex, than the thickness ({H:g} mm)")
        up = np.sqrt(R * R - (x**2).sum(axis=1))
        normals = np.column_stack([x / R, up / abs(R)])
        top = np.column_stack([x, H - R + np.sign(R) * up])
    X = top[None] - H * depths[:, None, None] * normals[None]
    return X.reshape(-1, 3), normals


def _frames(normals: Floats) -> Floats:
    """Axes (n, 3, 3), columns: the x axis drawn into the surface, what completes it, and the normal."""
    first = _unit(np.array([1.0, 0.0, 0.0]) - normals[:, :1] * normals)
    return np.stack([first, np.cross(normals, first), normals], axis=-1)


def _unit(v: Floats) -> Floats:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))

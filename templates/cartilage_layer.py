"""Whole cartilage: the layer's mesh, its materials zone by zone, the indenter and the course of the load."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from febkit.model import ElementBlock, InputError, Mesh, NodeSet, Surface
from febkit.model.mesh import Floats, Ints, SurfacePair

from .course import course
from .depth_fields import PLAIN, PLAIN_GROUND, Fields, directions
from .expression import written
from .indenter import indenter
from .layer import Layer, layer
from .parts import Generated
from .profile import profile
from .quality import judge

FIELDS = ("E", "v", "beta", "k0", "M", "alpha", "phi0", "charge", "ksi1", "ksi2", "ksi3", "ksi", "fibre_alpha",
          "fibre_beta", "fibre_angle")  # fmt: skip
DRAINED = ("top", "bottom", "sides")


def cartilage(p: Mapping[str, Any]) -> Generated:
    """The model's mesh, maps and facts from the template's parameters (see templates/cartilage/template.toml)."""
    wrong = [f for f in p["drained"] if f not in DRAINED]
    if wrong:
        raise InputError(f"drained: there is no face '{wrong[0]}'; faces are {', '.join(DRAINED)}")
    fields = _fields(p)
    made = fields.layer
    materials = [_material(p, fields, part, k) for k, part in enumerate(made.parts, 1)]
    parts: dict[str, Ints] = dict(made.parts)
    X, surfaces = made.X, dict(made.surfaces)
    pressed = p["pressed_by"] != "plate"
    if pressed:
        body, hexes, face = indenter(p, made.thickness)
        parts["indenter"], surfaces["indenter_tip"] = hexes + len(X), face + len(X)
        X = np.concatenate([X, body])
    quality = judge(made.X, [("hex8", conn) for conn in made.parts.values()])
    if quality.jacobian_min <= 0.0:
        raise InputError("the mesh has elements turned inside out: take a greater curvature, or fewer layers or rings")
    load = course(p)
    steps = max(1, round(load.times[-1] / (float(p["first_step"]) or load.times[1])))
    facts = {
        "materials": materials, "parts": [[name, name] for name in made.parts], "pressed": pressed,
        "faces": _held(p, surfaces), "points": load.points, "must": load.times,
        "depth": float(p["compression"]) * made.thickness,
        "count": steps, "first": load.times[-1] / steps,
    }  # fmt: skip
    zones = {z: tuple(n for n in made.parts if made.zone[n] == k) for k, z in enumerate(made.zones)}
    report = {"nodes": len(X), "elements": sum(map(len, parts.values())), "quality": quality}
    report |= {zone: _said(made, names) for zone, names in zones.items()}
    lists = {"cartilage": tuple(made.parts)} | {z: names for z, names in zones.items() if z not in made.parts}
    return Generated(_mesh(X, parts, surfaces, lists), facts, report, tuple(fields.data))


def _fields(p: Mapping[str, Any]) -> Fields:
    """The layer and its properties: cut into zones, or into layers of elements where a property asks for that."""
    profiles = {n: profile(n, p[n]) for n in FIELDS}
    plain = PLAIN + PLAIN_GROUND[p["ground"]]
    fields = Fields(layer(p, p["parts"] == "layers"), profiles, p["fields"] == "formulas", plain)
    if p["parts"] == "auto" and fields.bent():
        fields.layer = layer(p, True)
    return fields


def _said(made: Layer, parts: tuple[str, ...]) -> str:
    z = np.concatenate([made.depth[n] for n in parts])
    cut = f" in {len(parts)} parts" if len(parts) > 1 else ""
    return f"{len(z)} elements{cut}, depth {z.min():.3g} to {z.max():.3g} (centres)"


def _material(p: Mapping[str, Any], f: Fields, part: str, number: int) -> dict[str, Any]:
    """What the skeleton asks of a part's material: [type, text] of each property that is used."""
    used = ["E", "v", *(["beta"] if p["ground"] == "Holmes-Mow" else []), "k0", "M", "alpha", "phi0"]
    used += ["charge"] if p["physics"] == "multiphasic" else []
    fibres = p["fibres"]
    if fibres in ("spherical", "families"):
        used += ["ksi", "fibre_alpha"]
    out: dict[str, Any] = {name: f.text(name, part) for name in used}
    if fibres == "ellipsoidal":
        out |= {"ksi": f.vector(("ksi1", "ksi2", "ksi3"), part), "fibre_beta": f.vector(("fibre_beta",) * 3, part)}
        if not f.layer.flat:
            frame = f.layer.frame[part]
            f.map("mat_axis", part, np.concatenate([frame[:, :, 0], frame[:, :, 1]], axis=1), type="mat_axis")
    elif fibres != "none":
        out["fibre_beta"] = f.text("fibre_beta", part)
    out["directions"] = _directions(p, f, part) if fibres == "families" else []
    return out | {"id": number, "name": part}


def _directions(p: Mapping[str, Any], f: Fields, part: str) -> list[list[str]]:
    """[type, text] of the direction of each family of fibres."""
    layer_ = f.layer
    angle = f.profiles["fibre_angle"].zone(layer_.zone[part], len(layer_.zones), "fibre_angle").at(layer_.depth[part])
    out = []
    for k, azimuth in enumerate(p["azimuths"], 1):
        v = directions(angle, float(azimuth), layer_.frame[part])
        same = bool(np.ptp(v, axis=0).max() < 1e-12)
        out.append(["vector", written(v[0].tolist())] if same else
                   ["map", f.map(f"fibre_{k}_{part}", part, v, data_type="vec3")])
    return out


def _held(p: Mapping[str, Any], surfaces: Mapping[str, Ints]) -> list[list[Any]]:
    """Faces that slide: name, and 1 where x and y are held."""
    out: list[list[Any]] = []
    if p["sides"] == "confined":
        out += [["x_faces", 1, 0], ["y_faces", 0, 1]] if p["shape"] == "column" else [["sides", 1, 1]]
    planes: list[list[Any]] = [["x_plane", 1, 0], ["y_plane", 0, 1]]
    return out + [face for face in planes if face[0] in surfaces]


def _mesh(X: Floats, parts: Mapping[str, Ints], surfaces: Mapping[str, Ints],
          lists: Mapping[str, tuple[str, ...]]) -> Mesh:  # fmt: skip
    """The model's mesh, ids from 1 in order of the parts; each surface is a node set, too."""
    blocks, first = [], 1
    for name, conn in parts.items():
        blocks.append(ElementBlock(name, "hex8", np.arange(first, first + len(conn)), conn))
        first += len(conn)
    sets = {name: np.unique(quads) for name, quads in surfaces.items()}
    if "left" in surfaces:
        sets |= {"x_faces": np.union1d(sets["left"], sets["right"]), "y_faces": np.union1d(sets["front"], sets["back"])}
    tissue = np.unique(np.concatenate([conn.ravel() for name, conn in parts.items() if name != "indenter"]))
    sets["tissue"] = tissue
    return Mesh(
        node_ids=np.arange(1, len(X) + 1), X=X, blocks=tuple(blocks),
        node_sets={k: NodeSet(k, v) for k, v in sets.items()},
        surfaces={k: Surface(k, {"quad4": v}, {"quad4": np.arange(1, len(v) + 1)}) for k, v in surfaces.items()},
        surface_pairs={"contact": SurfacePair("contact", "top", "indenter_tip")} if "indenter" in parts else {},
        part_lists=lists,
        node_blocks={"nodes": np.arange(len(X))},
    )  # fmt: skip

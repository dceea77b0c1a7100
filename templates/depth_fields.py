"""Profiles over depth as a model file has them, part by part: a number, a formula of Z, or a map of elements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from febkit.model import Component, InputError, MeshData
from febkit.model.mesh import Floats

from .expression import written
from .layer import Layer
from .profile import Profile

# what FEBio 4.11 reads as one number for each material: of perm-Holmes-Mow, and of the ground where it is Holmes-Mow
PLAIN = ("M", "alpha")
PLAIN_GROUND = {"neo-Hookean": (), "Holmes-Mow": ("E", "v", "beta")}


@dataclass(slots=True)
class Fields:
    """Writes the profiles of one layer; the maps that this takes gather in ``data``."""

    layer: Layer
    profiles: Mapping[str, Profile]
    formulas: bool
    plain: tuple[str, ...] = PLAIN
    data: list[MeshData] = field(default_factory=list)

    def text(self, name: str, part: str, mapped: bool = False) -> list[str]:
        """[type, text] of a property in a part; the type of a number is empty. ``mapped``: as a map in any case."""
        p = self.profiles[name].zone(self.layer.zone[part], len(self.layer.zones), name)
        values = p.at(self.layer.depth[part])
        if not mapped and _even(values):
            return ["", written(float(values[0]))]
        if name in self.plain:
            raise InputError(f"{name} varies within the part {part}, and FEBio 4.11 takes one number of it for each "
                             "material: give one number for each zone, or leave parts to the template", p.where)
        if not mapped and self.formulas and p.rule == "linear" and self.layer.flat:
            return ["math", formula(p, self.layer.thickness)]
        return ["map", self.map(f"{name}_{part}", part, values[:, None])]

    def bent(self) -> bool:
        """Does a property vary within a part that must be one number there?"""
        count = len(self.layer.zones)
        return any(not _even(self.profiles[name].zone(self.layer.zone[part], count, name).at(depth))
                   for name in self.plain for part, depth in self.layer.depth.items())

    def vector(self, names: Sequence[str], part: str) -> list[str]:
        """[type, text] of a parameter that takes several properties: numbers, formulas or maps, but one kind for
        all."""
        kept = len(self.data)
        kinds, texts = zip(*(self.text(name, part) for name in names), strict=True)
        if len(set(kinds)) > 1 and "map" in kinds:
            del self.data[kept:]
            kinds, texts = zip(*(self.text(name, part, mapped=True) for name in names), strict=True)
        return [max(kinds), ",".join(texts)]

    def map(self, name: str, part: str, rows: Floats, **attrs: str) -> str:
        """Enters rows (element, component) as a map, and gives its name."""
        if any(d.name == name and d.set == part for d in self.data):
            return name
        given = {"elem_set": part} | ({} if "type" in attrs else {"name": name}) | attrs
        self.data.append(MeshData("element", attrs.get("type", name), part, Component("ElementData", attrs=given),
                                  np.arange(1, len(rows) + 1), rows))
        return name


def _even(values: Floats) -> bool:
    return bool(np.ptp(values) <= 1e-12 * np.abs(values).max())


def formula(p: Profile, thickness: float) -> str:
    """A table with straight lines as a + b Z + sum c |Z - z_k|, with Z = thickness (1 - depth).

    The |Z - z_k| at the rows in between bend the line by the change of its slope; those of a first row below the
    surface and of a last one above the bone hold it level beyond them.
    """
    z = thickness * (1.0 - np.array(p.depths[::-1]))
    v = np.array(p.values[::-1])
    slopes = [0.0, *(np.diff(v) / np.diff(z)), 0.0]
    a, b, terms = (v[0] + v[-1]) / 2.0, 0.0, ""
    for at, (before, after) in zip(z.tolist(), pairwise(slopes), strict=True):
        half = float(after - before) / 2.0
        if abs(at) < 1e-12 * thickness or abs(at - thickness) < 1e-12 * thickness:
            side = 1.0 if abs(at) < 1e-12 * thickness else -1.0  # the layer lies on one side of this row
            a, b = a - side * half * at, b + side * half
        elif half:
            terms += f"{'+' if half > 0 else '-'}{written(abs(half))}*abs(Z-{written(at)})"
    line = f"{'+' if b > 0 else '-'}{written(abs(b))}*Z" if b else ""
    return f"{written(float(a))}{line}{terms}"


def directions(angle: Floats, azimuth: float, frame: Floats) -> Floats:
    """Unit vectors (element, 3), ``angle`` degrees (element,) from the articular surface towards its normal,
    ``azimuth`` degrees about the normal from the x axis."""
    t, f = np.radians(angle), np.radians(azimuth)
    local = np.stack([np.cos(t) * np.cos(f), np.cos(t) * np.sin(f), np.sin(t)], axis=-1)
    return np.asarray(np.einsum("eij,ej->ei", frame, local))

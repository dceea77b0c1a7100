"""Turns the regions of one plot variable into one array per state."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from febkit.model import InputError

from .xplt.floats import Floats
from .xplt.reader import PlotFile
from .xplt.records import MeshOutline, PlotMesh, PlotSurface, PlotVariable

Place = slice | np.ndarray


class Places:
    """Where each region's items belong in arrays over the whole mesh."""

    def __init__(self, outline: MeshOutline, mesh: Callable[[], PlotMesh]) -> None:
        self.outline = outline
        self.mesh = mesh
        self.elements = _spans([d.count for d in outline.domains])
        self.facets = _spans([len(s.rows()) for s in outline.surfaces])
        self.lines = _spans([len(s.rows()) for s in outline.edges])
        self._nodes: dict[tuple[str, int], np.ndarray] = {}
        self._gathers: dict[tuple[int, ...], np.ndarray] = {}

    def gather(self, regions: tuple[int, ...]) -> np.ndarray:
        """Row of each node in the values of these domains one after the other, the last domain that has it;
        one row past the end where none has it."""
        if regions not in self._gathers:
            nodes = [self.nodes("domain", r - 1) for r in regions]
            end = sum(map(len, nodes))
            rows = np.full(self.outline.n_nodes, end)
            rows[np.concatenate(nodes)] = np.arange(end)
            self._gathers[regions] = rows
        return self._gathers[regions]

    def count(self, section: str) -> int:
        """Regions of a section."""
        return len(self.items(section))

    def surfaces(self, section: str) -> Sequence[PlotSurface]:
        return self.outline.surfaces if section == "surface" else self.outline.edges

    def items(self, section: str) -> list[slice]:
        return {"domain": self.elements, "surface": self.facets, "edge": self.lines}[section]

    def nodes(self, section: str, index: int) -> np.ndarray:
        """Node indices of a region in first-seen order, found once."""
        key = (section, index)
        if key not in self._nodes:
            r = self.mesh().domains[index] if section == "domain" else self.surfaces(section)[index]
            self._nodes[key] = r.nodes()
        return self._nodes[key]

    def region_nodes(self, section: str) -> list[slice]:
        """Spans of the regions' own node lists, one after the other."""
        return _spans([len(self.nodes(section, i)) for i in range(self.count(section))])

    def local(self, section: str, index: int) -> int:
        """Local nodes of a region's elements or facets."""
        if section == "domain":
            return self.outline.domains[index].width
        return int(self.surfaces(section)[index].rows().shape[1])

    def width(self, section: str) -> int:
        """Local nodes of the widest element or facet."""
        return max((self.local(section, i) for i in range(self.count(section))), default=0)


def _spans(sizes: Sequence[int]) -> list[slice]:
    ends = np.cumsum([0, *sizes])
    return [slice(int(a), int(b)) for a, b in pairwise(ends)]


@dataclass
class Field:
    """A plot variable as frames of one shape, one frame a state, NaN where the file says nothing.

    ``shape`` leads with the items (nodes, elements, facets, ...; none for global values), then local
    nodes for "mult", then components where there is more than one.
    """

    file: PlotFile
    states: np.ndarray  # indices of the file's states
    index: int  # of the variable in the dictionary
    variable: PlotVariable
    places: Places
    apart: bool = False  # domain nodal data by (domain, node) pair instead of by node
    shape: tuple[int, ...] = field(init=False)
    dtype: Any = np.float32

    def __post_init__(self) -> None:
        self._spans = self._region_spans()
        v = self.variable
        lead: tuple[int, ...] = () if v.section == "global" else (self._rows(),)
        if v.format == "mult" and v.section not in ("node", "global"):
            lead = (*lead, self.places.width(v.section))
        self.shape = (*lead, *tail(v))

    def _rows(self) -> int:
        v, p = self.variable, self.places
        if v.section == "node" or (v.section == "domain" and v.format == "node" and not self.apart):
            return p.outline.n_nodes
        return self._spans[-1].stop if self._spans else 0

    def _region_spans(self) -> list[slice]:
        v, p = self.variable, self.places
        if v.section in ("node", "global"):
            return []
        if v.format == "node":
            return p.region_nodes(v.section) if self.apart or v.section != "domain" else []
        if v.format == "region":
            return _spans([1] * p.count(v.section))
        return p.items(v.section)

    def place(self, region: int) -> tuple[Place, int, int]:
        """(rows of the array, items, local nodes) of a region's values; local is 0 but for "mult"."""
        v, p = self.variable, self.places
        if v.section in ("node", "global"):
            if region:
                raise self._bad(region, "all nodes are region 0")
            return slice(None), self._rows() if v.section == "node" else 1, 0
        if not 1 <= region <= p.count(v.section):
            raise self._bad(region, f"the mesh has {p.count(v.section)}")
        if v.format == "node" and v.section == "domain" and not self.apart:
            nodes = p.nodes("domain", region - 1)
            return nodes, len(nodes), 0
        span = self._spans[region - 1]
        local = p.local(v.section, region - 1) if v.format == "mult" else 0
        return span, span.stop - span.start, local

    def _bad(self, region: int, why: str) -> InputError:
        return InputError(
            f"{self.variable.name!r} has data of {self.variable.section} region {region}: {why}",
            self.file.container.where,
        )

    def _found(self, t: int) -> list[tuple[int, Floats]]:
        return list(self.file.floats(self.index, int(self.states[t])))

    def frame(self, t: int) -> np.ndarray:
        """The array of one state."""
        out = np.empty(self.shape, np.float32)
        self.fill(t, out)
        return out

    def rows(self, t: int, rows: np.ndarray) -> np.ndarray:
        """Items ``rows`` of the array of one state; little else is read."""
        found = self._found(t)
        out, inner = np.full((len(rows), *self.shape[1:]), np.nan, np.float32), self.shape[1:]
        at = self.places.gather(tuple(r for r, _ in found))[rows] if found and self._merged else rows
        end = 0
        for region, values in found:
            place, n, local = self.place(region)
            start = end if self._merged or not isinstance(place, slice) else place.start or 0
            end = start + n
            have = self._width(values, region, n, local) if local else 1
            if not local:
                self._sized(values, region, n)
            mine = np.flatnonzero((at >= start) & (at < end))
            if len(mine):
                some = values.rows(at[mine] - start, have * self.variable.values)
                if local:
                    some = some.reshape(len(mine), have, self.variable.values)[:, :local]
                    out[mine, : some.shape[1]] = some.reshape(len(mine), some.shape[1], *inner[1:])
                else:
                    out[mine] = some.reshape(len(mine), *inner)
        return out

    def fill(self, t: int, out: np.ndarray) -> None:
        """Write the array of one state into ``out``."""
        found = self._found(t)
        if found and self._merged:
            self._merge(found, out)
            return
        if not self._covers([r for r, _ in found]):
            out.fill(np.nan)
        inner = self.shape[1:]
        for region, values in found:
            place, rows, local = self.place(region)
            if self.variable.section == "global":
                out[...] = self._sized(values, region, 1).read().reshape(self.shape)
            elif local:
                have = self._width(values, region, rows, local)
                block = values.read().reshape(rows, have, self.variable.values)[:, :local]
                out[place, : block.shape[1]] = block.reshape(rows, block.shape[1], *inner[1:])
            else:
                self._sized(values, region, rows).into(out[place])

    @property
    def _merged(self) -> bool:
        """Whether nodal values of several domains go into one array."""
        return self.variable.section == "domain" and self.variable.format == "node" and not self.apart

    def _merge(self, found: list[tuple[int, Floats]], out: np.ndarray) -> None:
        nc = self.variable.values
        parts = [self._sized(values, r, self.place(r)[1]) for r, values in found]
        flat = np.empty(sum(p.size for p in parts) + nc, np.float32)
        end = 0
        for p in parts:
            p.into(flat[end : end + p.size])
            end += p.size
        flat[end:] = np.nan  # for nodes that none of these domains has
        rows = flat.reshape(-1, *self.shape[1:])
        np.take(rows, self.places.gather(tuple(r for r, _ in found)), axis=0, out=out, mode="clip")

    def _covers(self, regions: list[int]) -> bool:
        """Whether these regions fill the whole array."""
        v = self.variable
        if v.section in ("node", "global"):
            return bool(regions)
        if v.format == "mult":
            return False
        return len(set(regions)) == self.places.count(v.section)

    def _sized(self, values: Floats, region: int, rows: int) -> Floats:
        want = rows * self.variable.values
        if values.size != want:
            raise self._bad(region, f"{values.size} values where {want} belong")
        return values

    def _width(self, values: Floats, region: int, rows: int, local: int) -> int:
        """Local nodes that the file has values for; surfaces may be padded beyond their widest facet."""
        nc = self.variable.values
        if rows == 0 or values.size % (rows * nc):
            raise self._bad(region, f"{values.size} values for {rows} items")
        have = values.size // (rows * nc)
        if have < local or (have > local and self.variable.section == "domain"):
            raise self._bad(region, f"{have} values an item where {local} belong")
        return have

    def regions_with_data(self, t: int = 0) -> list[int]:
        return [r for r, _ in self._found(t)]


def tail(v: PlotVariable) -> tuple[int, ...]:
    """Shape of one value."""
    if v.type == "array vec3f":
        return (v.n, 3)
    return (v.values,) if v.values > 1 or (v.type == "array" and species(v)) else ()


def species(v: PlotVariable) -> str | None:
    """The dimension of an array over the solutes, or the solid-bound molecules, of the whole model; else None."""
    return SPECIES.get(v.name.split("=")[0].strip()) if v.type.startswith("array") and v.n else None


def components(v: PlotVariable) -> tuple[str | None, tuple[str, ...]]:
    """Name of the component dimension and its labels; (None, ()) for scalars and arrays."""
    return _COMPONENTS.get(v.type, (None, ()))


# arrays over the species of <Globals>: FEBio sizes them by the model, not by the part (FEBioMixPlot)
SPECIES = {
    **dict.fromkeys((
        "effective solute concentration", "effective shell solute concentration", "solute concentration",
        "concentration gap", "partition coefficient", "solute flux", "solute volumetric flux",
    ), "solute"),
    **dict.fromkeys((
        "sbm concentration", "sbm areal concentration", "sbm referential apparent density",
    ), "solid_bound"),
}  # fmt: skip
_COMPONENTS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "vec3f": ("xyz", ("x", "y", "z")),
    "mat3fs": ("voigt", ("xx", "yy", "zz", "xy", "yz", "xz")),
    "mat3fd": ("principal", ("1", "2", "3")),
    "mat3f": ("tensor", ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz")),
    "tens4fs": ("voigt4", tuple(f"{i}{j}" for j in range(1, 7) for i in range(1, j + 1))),
}

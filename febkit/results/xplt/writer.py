"""Writes a plotfile state by state, as FEBio 4.11 does (version 0x35); needs only numpy."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping, Sequence
from os import PathLike
from types import TracebackType

import numpy as np
from numpy.typing import ArrayLike

from febkit.files import Buffer, Mark, Output, may_write
from febkit.model.source import InputError

from . import encode, tags
from .records import PlotMesh, PlotVariable

Data = Mapping[str | int, Mapping[int, ArrayLike] | ArrayLike]


class PlotWriter:
    """A plotfile being written: beside its place (:class:`febkit.files.Output`), and put there with its first state
    where ``live``, else when it is closed. Every state is written whole or not at all.

    ``data`` of a state maps a variable's name (or place in ``variables``, where two share a name) to
    ``{region: values}``. A region is 0 (all nodes, or
    global), a domain's index + 1, or a surface's index + 1. One bare array stands for all regions: rows by
    node for nodal variables and for domain variables of format "node", rows by element (domains one after
    the other) for format "item". A variable left out is written empty, as FEBio does where a field does
    not exist.

    ``mark``: go on with the plotfile in place, from where it stood then (:meth:`febkit.files.Output.mark`).
    """

    def __init__(
        self,
        path: str | PathLike[str] | Buffer,
        mesh: PlotMesh,
        variables: Sequence[PlotVariable],
        version: int = 0x35,
        compress: bool = False,
        software: str | None = "febkit",
        units: str | None = None,
        author: str | None = None,
        live: bool = True,
        overwrite: bool = True,
        mark: Mark | None = None,
    ) -> None:
        if version not in (0x30, 0x31, 0x32, 0x33, 0x34, 0x35):
            raise ValueError(f"plotfile versions 0x30 to 0x35 can be written, not {version:#x}")
        self.version = version
        self.compress = compress
        self.variables = tuple(variables)
        self._keys = frozenset([v.name for v in variables]) | frozenset(range(len(variables)))
        self._sections = [(tag, self._numbered(section)) for section, (_, tag) in tags.SECTIONS.items()]
        self._head = encode.block(
            tags.ROOT,
            encode.header(version, compress, software, units, author),
            encode.dictionary(self.variables, units is not None),
        )
        self._meshes, self._live = 0, live
        if not isinstance(path, Buffer):
            may_write(path, overwrite)
        self.output = path if isinstance(path, Buffer) else Output(path, mark=mark)
        try:
            start = [struct.pack("<I", tags.MAGIC), self._head, self._take(mesh)]
            if mark is None:
                self.output.write(*start)
            elif not self.output.begins(b"".join(start)):
                raise InputError(f"{path}: this plotfile holds other variables or another mesh than the model asks "
                                 "for: ask for the same, or start anew without --resume")  # fmt: skip
        except BaseException:
            self.output.discard()
            raise

    def _numbered(self, section: str) -> list[tuple[int, PlotVariable, bytes]]:
        """The variables of a section with their places among all, and the block that numbers each in the section."""
        mine = [(i, v) for i, v in enumerate(self.variables) if v.section == section]
        return [(i, v, encode.integer(tags.STATE_VAR_ID, k)) for k, (i, v) in enumerate(mine, start=1)]

    def mesh(self, mesh: PlotMesh) -> None:
        """Write a mesh section that replaces the first for the states that follow."""
        self.output.write(self._take(mesh))

    def _take(self, mesh: PlotMesh) -> bytes:
        """Have the states that follow be of a mesh; its section."""
        self._mesh = mesh
        self._sizes = _Sizes(mesh)
        self._active = np.ones(mesh.n_elements, "<u4").tobytes()
        body = encode.mesh(mesh, self.version)
        self._meshes += 1
        # FEBio's first mesh is plain even where states are compressed
        return zlib.compress(body) if self.compress and self._meshes > 1 else body

    def state(
        self,
        time: float,
        data: Data,
        status: int = 0,
        element_state: ArrayLike | None = None,
        objects: bytes = b"",
    ) -> None:
        """Append one state; ``status`` 0 converged, 1 the mesh changed, 2 not converged.

        ``element_state`` holds one flag per element (bit 0: active), all active where None; empty: none are listed.
        """
        if not self._keys.issuperset(data):
            unknown = [n for n in data if n not in self._keys]
            raise ValueError(f"not in the plotfile's dictionary: {', '.join(map(repr, unknown))}")
        head = encode.block(tags.STATE_HDR_TIME, struct.pack("<f", time))
        if self.version >= 0x31:
            head += encode.integer(tags.STATE_STATUS, status)
        flags = self._active if element_state is None else np.asarray(element_state, "<u4").tobytes()
        if len(flags) not in (0, len(self._active)):
            raise ValueError(f"element_state has {len(flags) // 4} flags for {self._mesh.n_elements} elements")
        parts = [
            encode.block(tags.STATE_HEADER, head),
            encode.block(tags.MESH_STATE, encode.block(tags.ELEMENT_STATE, flags)),
            *self._state_data(data),
        ]
        if objects:
            parts.append(encode.block(tags.OBJECTS_STATE, objects))
        whole = _wrap(tags.STATE, parts)
        self.output.write(*([zlib.compress(b"".join(whole))] if self.compress else whole))
        if self._live:
            self.output.place()

    def _state_data(self, data: Data) -> list[bytes]:
        sections: list[bytes] = []
        for tag, mine in self._sections:
            body: list[bytes] = []
            for i, v, number in mine:
                regions: list[bytes] = []
                for region, values in self._sizes.regions(v, data.get(i, data.get(v.name))):
                    regions += [struct.pack("<II", region, values.nbytes), values.tobytes()]
                body += _wrap(tags.STATE_VARIABLE, [number, *_wrap(tags.STATE_VAR_DATA, regions)])
            if body:
                sections += _wrap(tag, body)
        return _wrap(tags.STATE_DATA, sections)

    def close(self) -> None:
        """Put the file in place and end it."""
        self.output.close()

    def discard(self) -> None:
        """End the file; what stood in its place stays, unless this file has taken it."""
        self.output.discard()

    def __enter__(self) -> PlotWriter:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if error is None:
            self.close()
        else:
            self.discard()


def _wrap(tag: int, parts: Sequence[bytes]) -> list[bytes]:
    """A block whose payload stays in pieces, so that large arrays are copied once."""
    size = sum(map(len, parts))
    if size > encode.LIMIT:
        raise ValueError(f"a plotfile state holds at most 4 GiB, this one needs {size} bytes")
    return [struct.pack("<II", tag, size), *parts]


class _Sizes:
    """How many values each region of each format holds on a mesh, found when first needed."""

    def __init__(self, mesh: PlotMesh) -> None:
        self.mesh = mesh
        self._nodes: dict[tuple[str, int], np.ndarray] = {}
        self._items: dict[tuple[str, str, int], int] = {}

    def nodes(self, section: str, region: int) -> np.ndarray:
        """Node indices of a region, in the order of FMT_NODE data."""
        key = (section, region)
        if key not in self._nodes:
            self._nodes[key] = self._of(section)[region - 1].nodes()
        return self._nodes[key]

    def _of(self, section: str) -> Sequence:
        m = self.mesh
        return {"domain": m.domains, "surface": m.surfaces, "edge": m.edges}[section]

    def regions(self, v: PlotVariable, given: object) -> list[tuple[int, np.ndarray]]:
        """(region, float32 values) of a variable, sizes checked."""
        if given is None:
            return []
        by_region = given if isinstance(given, Mapping) else self._split(v, np.asarray(given))
        out = []
        for region, values in by_region.items():
            a = np.ascontiguousarray(values, "<f4")
            if v.format == "mult" and v.section in ("surface", "edge") and a.ndim >= 2:
                a = self._pad(v, region, a)
            want = self.items(v, region) * v.values
            if a.size != want:
                raise ValueError(f"{v.name!r}, region {region}: {a.size} values where {want} belong")
            out.append((int(region), a))
        return out

    def items(self, v: PlotVariable, region: int) -> int:
        """Items of a region: nodes, elements, or elements times local nodes."""
        key = v.section, v.format, region
        if key not in self._items:
            self._items[key] = self._count(v, region)
        return self._items[key]

    def _count(self, v: PlotVariable, region: int) -> int:
        if v.section == "global":
            return 1
        if v.section in ("node", "material"):
            return len(self.mesh.node_ids) if v.section == "node" else 1
        of = self._of(v.section)
        if not 1 <= region <= len(of):
            raise ValueError(f"{v.name!r}: no {v.section} {region}, there are {len(of)}")
        r = of[region - 1]
        rows, width = r.conn.shape if v.section == "domain" else r.rows().shape
        if v.section == "edge":
            width = max(width, 3)
        if v.format == "node":
            return len(self.nodes(v.section, region))
        return int({"item": rows, "mult": rows * width, "region": 1}[v.format])

    def _split(self, v: PlotVariable, a: np.ndarray) -> dict[int, np.ndarray]:
        """One bare array to regions."""
        if v.section in ("node", "global", "material"):
            return {0: a}
        of = self._of(v.section)
        if v.format == "node" and a.size == len(self.mesh.node_ids) * v.values:
            rows = a.reshape(len(self.mesh.node_ids), v.values)
            return {i + 1: rows[self.nodes(v.section, i + 1)] for i in range(len(of))}
        if v.format == "item":
            sizes = [len(r.element_ids) if v.section == "domain" else len(r.rows()) for r in of]
            if a.size == sum(sizes) * v.values:
                parts = np.split(a.reshape(-1, v.values), np.cumsum(sizes)[:-1])
                return {i + 1: p for i, p in enumerate(parts)}
        if v.format == "region" and a.size == len(of) * v.values:
            return {i + 1: r for i, r in enumerate(a.reshape(len(of), v.values))}
        if len(of) == 1:
            return {1: a}
        raise ValueError(f"{v.name!r}: give {{region: values}}; {a.size} values do not fit {len(of)} regions")

    def _pad(self, v: PlotVariable, region: int, a: np.ndarray) -> np.ndarray:
        """Zero-pad facets to the widest of the surface."""
        rows = len(a)
        width = self.items(v, region) // max(rows, 1)
        have = a.size // max(rows * v.values, 1)
        if have >= width:
            return a
        return np.pad(a.reshape(rows, have, v.values), ((0, 0), (0, width - have), (0, 0)))

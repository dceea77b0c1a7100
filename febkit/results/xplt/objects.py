"""Objects of a plotfile: points (rigid bodies, connectors) and lines (springs), with data of their own.

The mesh section names them and lists their data; each state holds position, rotation and values.
Source: FEBio 4.11 FEBioPlot/FEBioPlotFile.cpp, WriteObjectsSection and WriteObjectsState.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from febkit.model import InputError

from . import encode, tags
from .records import PlotVariable

ID, NAME, TAG, POS, ROT, DATA = (0x01050000 + i for i in range(1, 7))
POINT, POINT_COORD = 0x01051000, 0x01051001
LINE, LINE_COORDS = 0x01052000, 0x01052001


@dataclass(frozen=True, slots=True)
class PlotObject:
    """A point or line object. ``tag`` is FEBio's kind: 1 rigid body, 2 spherical joint, ..."""

    name: str
    id: int
    tag: int = 1
    line: bool = False
    position: ArrayLike = (0.0, 0.0, 0.0)
    rotation: ArrayLike = (0.0, 0.0, 0.0, 1.0)  # quaternion x, y, z, w
    ends: ArrayLike = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # of a line
    data: Sequence[PlotVariable] = ()


@dataclass(slots=True)
class ObjectState:
    """One object at one time; ``coordinates`` is a point, or the two ends of a line."""

    position: ArrayLike
    rotation: ArrayLike = (0.0, 0.0, 0.0, 1.0)
    coordinates: ArrayLike = ()
    values: Mapping[int, ArrayLike] = field(default_factory=dict)  # by place in the object's data


def _floats(tag: int, values: ArrayLike) -> bytes:
    return encode.block(tag, np.asarray(values, "<f4").tobytes())


def section(objects: Sequence[PlotObject]) -> bytes:
    """The payload for ``PlotMesh.objects``: points first, then lines."""
    out = b""
    for o in sorted(objects, key=lambda o: o.line):
        body = [encode.integer(ID, o.id), encode.text(NAME, o.name), encode.integer(TAG, o.tag),
                _floats(POS, o.position), _floats(ROT, o.rotation)]
        if o.line:
            body.append(_floats(LINE_COORDS, o.ends))
        body += [encode.block(DATA, encode.dictionary_item(v, False)[8:]) for v in o.data]
        out += encode.block(LINE if o.line else POINT, *body)
    return out


def state(objects: Sequence[PlotObject], states: Mapping[str, ObjectState]) -> bytes:
    """The payload for ``PlotWriter.state(objects=...)``, by name of object."""
    out = b""
    for o in sorted(objects, key=lambda o: o.line):
        s = states[o.name]
        data = b"".join(_floats(k, v) for k, v in s.values.items())
        where = s.coordinates if np.size(s.coordinates) else (o.ends if o.line else s.position)
        out += encode.block(
            LINE if o.line else POINT, encode.integer(ID, o.id),
            _floats(POS, s.position), _floats(ROT, s.rotation),
            _floats(LINE_COORDS if o.line else POINT_COORD, where), encode.block(DATA, data),
        )
    return out


def _blocks(raw: bytes) -> Iterator[tuple[int, bytes]]:
    at = 0
    while at + 8 <= len(raw):
        tag, n = struct.unpack_from("<II", raw, at)
        if at + 8 + n > len(raw):
            break
        yield tag, raw[at + 8 : at + 8 + n]
        at += 8 + n
    if at != len(raw):
        raise InputError("damaged objects of a plotfile: stray bytes")


def _numbers(raw: bytes, n: int | None = None) -> np.ndarray:
    a = np.frombuffer(raw[: len(raw) // 4 * 4], "<f4").astype(np.float32)
    if n is not None and len(a) != n:
        raise InputError(f"damaged objects of a plotfile: {len(a)} numbers where {n} belong")
    return a


def _integer(raw: bytes) -> int:
    if len(raw) != 4:
        raise InputError("damaged objects of a plotfile: not an integer")
    return int(struct.unpack("<i", raw)[0])


def read_section(raw: bytes) -> list[PlotObject]:
    """The objects of a mesh section."""
    out: list[PlotObject] = []
    for kind, body in _blocks(raw):
        if kind not in (POINT, LINE):
            continue
        found = {k: v for k, v in _blocks(body) if k != DATA}
        data = [_variable(v) for k, v in _blocks(body) if k == DATA]
        name = found.get(NAME, b"\0\0\0\0")[4:].split(b"\0")[0].decode("utf-8", "replace")
        out.append(PlotObject(
            name, _integer(found[ID]) if ID in found else len(out) + 1,
            _integer(found[TAG]) if TAG in found else 0, kind == LINE,
            _numbers(found[POS], 3) if POS in found else (0.0,) * 3,
            _numbers(found[ROT], 4) if ROT in found else (0.0, 0.0, 0.0, 1.0),
            _numbers(found[LINE_COORDS], 6) if LINE_COORDS in found else (0.0,) * 6,
            data,
        ))
    return out


def _variable(raw: bytes) -> PlotVariable:
    found = dict(_blocks(raw))
    code = _integer(found.get(tags.DIC_ITEM_TYPE, b"\0\0\0\0"))
    if not 0 <= code < len(tags.ITEM_TYPES):
        raise InputError(f"damaged objects of a plotfile: data of type {code}")
    name = found.get(tags.DIC_ITEM_NAME, b"").split(b"\0")[0].decode("utf-8", "replace")
    return PlotVariable(name, "object", tags.ITEM_TYPES[code][0], "item")


def read_state(raw: bytes) -> list[tuple[bool, int, ObjectState]]:
    """(is a line, id, values) of every object of one state."""
    out: list[tuple[bool, int, ObjectState]] = []
    for kind, body in _blocks(raw):
        if kind not in (POINT, LINE):
            continue
        found = dict(_blocks(body))
        values = {k: _numbers(v) for k, v in _blocks(found.get(DATA, b""))}
        where = found.get(LINE_COORDS if kind == LINE else POINT_COORD, b"")
        s = ObjectState(
            _numbers(found[POS], 3) if POS in found else np.zeros(3, np.float32),
            _numbers(found[ROT], 4) if ROT in found else np.array([0, 0, 0, 1], np.float32),
            _numbers(where), values,
        )
        out.append((kind == LINE, _integer(found[ID]) if ID in found else 0, s))
    return out

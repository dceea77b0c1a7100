"""Reads the root section: versions, units and the dictionary of variables."""

from __future__ import annotations

from dataclasses import dataclass, field

from febkit.model import InputError

from . import tags
from .container import Bytes, Container
from .records import PlotVariable

ARRAY_LIMIT = 1 << 12  # components of an array variable; more is damage


@dataclass(slots=True)
class Header:
    """What the root section says of the file."""

    version: int = 0
    compression: int = 0
    software: str = ""
    author: str = ""
    units: str | None = None
    nodes: int = 0  # versions below 8
    facet_nodes: int = 4  # versions below 8
    variables: list[PlotVariable] = field(default_factory=list)
    parts: list[tuple[int, str]] = field(default_factory=list)  # versions below 8
    mesh: Bytes | None = None  # versions below 8 hold the mesh here


def read(c: Container) -> Header:
    """The root section, which every plotfile starts with."""
    if not c.blocks or c.blocks[0].tag != tags.ROOT:
        raise InputError("the plotfile has no complete root section (was its writing cut short?)", c.where)
    h = Header()
    for tag, b in c.children(c.payload(c.blocks[0]), "root section"):
        if tag == tags.HEADER:
            _header(c, b, h)
        elif tag == tags.DICTIONARY:
            _dictionary(c, b, h)
        elif tag == tags.MATERIALS:
            h.parts = parts(c, b, (tags.MATERIAL, tags.MAT_ID, tags.MAT_NAME))
        elif tag == tags.MESH:
            h.mesh = b
    if h.version not in tags.VERSIONS:
        raise InputError(f"plotfile version {h.version:#x} is not one of 1-8 and 0x30-0x35", c.where)
    return h


def _header(c: Container, root: Bytes, h: Header) -> None:
    for tag, b in c.children(root, "header"):
        if tag == tags.HDR_VERSION:
            h.version = c.word(b, "header")
        elif tag == tags.HDR_COMPRESSION:
            h.compression = c.word(b, "header")
        elif tag == tags.HDR_NODES:
            h.nodes = c.word(b, "header")
        elif tag == tags.HDR_MAX_FACET_NODES:
            h.facet_nodes = c.word(b, "header")
        elif tag == tags.HDR_AUTHOR:
            h.author = c.text(b)
        elif tag == tags.HDR_SOFTWARE:
            h.software = c.text(b)
        elif tag == tags.HDR_UNITS:
            h.units = c.text(b)


def _dictionary(c: Container, root: Bytes, h: Header) -> None:
    section_of = {dic: section for section, (dic, _) in tags.SECTIONS.items()}
    for tag, b in c.children(root, "dictionary"):
        if tag not in section_of:
            continue
        for kind, item in c.children(b, "dictionary"):
            if kind == tags.DIC_ITEM:
                h.variables.append(_item(c, item, section_of[tag]))


def _item(c: Container, item: Bytes, section: str) -> PlotVariable:
    code = fmt = n = 0
    name, units, array_names = "", None, []
    for tag, b in c.children(item, "dictionary item"):
        if tag == tags.DIC_ITEM_TYPE:
            code = c.word(b, "dictionary item")
        elif tag == tags.DIC_ITEM_FMT:
            fmt = c.word(b, "dictionary item")
        elif tag == tags.DIC_ITEM_ARRAYSIZE:
            n = c.word(b, "dictionary item")
        elif tag == tags.DIC_ITEM_ARRAYNAME:
            array_names.append(c.name64(b))
        elif tag == tags.DIC_ITEM_NAME:
            name = c.name64(b)
        elif tag == tags.DIC_ITEM_UNITS:
            units = c.name64(b)
    if code >= len(tags.ITEM_TYPES) or fmt >= len(tags.FORMATS):
        raise InputError(f"plot variable {name!r} has unknown type {code} or format {fmt}", c.where)
    type_, fixed = tags.ITEM_TYPES[code]
    if not fixed and not 0 < n <= ARRAY_LIMIT:
        raise InputError(f"plot variable {name!r} is an array of {n} components", c.where)
    return PlotVariable(name, section, type_, tags.FORMATS[fmt], n, units, tuple(array_names))


def parts(c: Container, section: Bytes, t: tuple[int, int, int]) -> list[tuple[int, str]]:
    """(id, name) of the materials."""
    one, id_, name_ = t
    out = []
    for tag, b in c.children(section, "parts"):
        if tag != one:
            continue
        number, name = 0, ""
        for k, v in c.children(b, "parts"):
            if k == id_:
                number = c.word(v, "parts")
            elif k == name_:
                name = c.name64(v)
        out.append((number, name))
    return out

"""Plotfiles made block by block, apart from the package's writer, and plotfiles of random content."""

from __future__ import annotations

import struct
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest

from febkit.results.xplt.records import PlotDomain, PlotMesh, PlotSurface, PlotVariable

SHARED = Path(__file__).parents[2].parent / "shared"


class Blocks:
    """Blocks by the format's rules alone: [u32 tag][u32 bytes][payload]."""

    def __init__(self, order: str = "<") -> None:
        self.order = order

    def block(self, tag: int, *body: bytes) -> bytes:
        data = b"".join(body)
        return struct.pack(self.order + "II", tag, len(data)) + data

    def ints(self, *values: int) -> bytes:
        return struct.pack(f"{self.order}{len(values)}i", *values)

    def floats(self, *values: float) -> bytes:
        return struct.pack(f"{self.order}{len(values)}f", *values)

    def int(self, tag: int, value: int) -> bytes:
        return self.block(tag, self.ints(value))

    def text(self, tag: int, text: str) -> bytes:
        return self.block(tag, self.ints(len(text)), text.encode())

    def name64(self, tag: int, text: str) -> bytes:
        return self.block(tag, text.encode().ljust(64, b"\0"))

    def item(self, kind: int, fmt: int, label: str, size: int = 0, name: bytes | None = None) -> bytes:
        return self.block(
            0x01020001, self.int(0x01020002, kind), self.int(0x01020003, fmt), self.int(0x01020005, size),
            name or self.name64(0x01020004, label),
        )

    def variable(self, number: int, *regions: tuple[int, bytes]) -> bytes:
        data = self.block(0x02020003, *(self.block(r, b) for r, b in regions))
        return self.block(0x02020001, self.int(0x02020002, number), data)

    def magic(self) -> bytes:
        return struct.pack(self.order + "I", 0x00464542)


# two hexahedra that share a face, and a triangle beside them
X = np.array([[x, y, z] for x in (0, 1, 2) for y in (0, 1) for z in (0, 1)], np.float32)
HEX = np.array([[0, 4, 6, 2, 1, 5, 7, 3], [4, 8, 10, 6, 5, 9, 11, 7]])


@pytest.fixture
def blocks() -> Blocks:
    return Blocks()


def modern(b: Blocks, version: int = 0x35, compression: int = 0, packed: str = "", states: int = 3,
           flags: tuple[int, ...] = (1, 1), stress: bytes | None = None, units: str = "mm-N-s") -> bytes:
    """Two domains (the second unnamed), a surface, sets, a nodal and two element variables.

    ``flags`` of the elements in every state; ``stress``: another block for that variable's name.
    """
    header = [b.int(0x01010001, version), b.int(0x01010004, compression), b.text(0x01010006, "FEBio 4.11.0")]
    if version >= 0x31:
        header += [b.text(0x01010007, units)] if units else []
    dictionary = b.block(
        0x01020000,
        b.block(0x01023000, b.item(1, 0, "displacement")),
        b.block(0x01024000, b.item(0, 0, "effective fluid pressure"), b.item(2, 1, "stress", name=stress)),
        b.block(0x01025000, b.item(0, 2, "contact gap")),
    )
    root = b.block(0x01000000, b.block(0x01010000, *header), dictionary)
    first = 101 if version >= 0x33 else 0  # ids since 0x33, indices before
    rows = b"".join(b.ints(first + i) + b.floats(*x) for i, x in enumerate(X))
    nodes = b.block(
        0x01041000, b.block(0x01041100, b.int(0x01041101, 12), b.int(0x01041102, 3)),
        b.block(0x01041200, rows),
    )

    def domain(number: int, name: bytes) -> bytes:
        head = b.block(
            0x01042101, b.int(0x01042102, 0), b.int(0x01042103, 1), b.int(0x01032104, 1), name
        )
        element = b.block(0x01042201, b.ints(number, *HEX[number - 1]))
        return b.block(0x01042100, head, b.block(0x01042200, element))

    domains = b.block(0x01042000, domain(1, b.text(0x01032105, "left")), domain(2, b""))
    faces = [b.ints(1, 4, 0, 4, 5, 1), b.ints(2, 3, 4, 8, 9, 777)]  # the last entry of a triangle is junk
    surface = b.block(
        0x01043000,
        b.block(
            0x01043100,
            b.block(0x01043101, b.int(0x01043102, 1), b.int(0x01043103, 2), b.text(0x01043104, "front"),
                    b.int(0x01043105, 4)),
            b.block(0x01043200, *(b.block(0x01043201, f) for f in faces)),
        ),
    )
    node_set = b.block(
        0x01044000,
        b.block(
            0x01044100,
            b.block(0x01044101, b.int(0x01044102, 1), b.int(0x01044104, 2), b.text(0x01044103, "fix")),
            b.block(0x01044200, b.ints(0, 1)),
        ),
    )
    parts = b.block(
        0x01045000, b.block(0x01045100, b.int(0x01045101, 1), b.name64(0x01045102, "tissue"))
    )
    mesh = b.block(0x01040000, nodes, domains, surface, node_set, parts)
    return b.magic() + root + mesh + b"".join(
        modern_state(b, version, packed, t, flags) for t in range(states)
    )


def first_seen(conn: np.ndarray) -> list[int]:
    return list(dict.fromkeys(conn.ravel().tolist()))


def modern_state(b: Blocks, version: int, packed: str, t: int, element_flags: tuple[int, ...]) -> bytes:
    """Displacement 10 t + 3 node + component; pressure 100 t + node; stress 1000 t + 6 element + component."""
    head = [b.block(0x02010002, b.floats(0.1 * t))]
    if version >= 0x31:
        head.append(b.int(0x02010003, 0))
    u = b.floats(*(10 * t + np.arange(36)))
    p = [(k + 1, b.floats(*(100 * t + np.array(first_seen(HEX[k]))))) for k in (0, 1)]
    s = [(k + 1, b.floats(*(1000 * t + 6 * k + np.arange(6)))) for k in (0, 1)]
    gap = [(1, b.floats(1, 2, 3, 4, 5, 6, 7, 0))]
    data = b.block(
        0x02020000,
        b.block(0x02020300, b.variable(1, (0, u))),
        b.block(0x02020400, b.variable(1, *p), b.variable(2, *s)),
        b.block(0x02020500, b.variable(1, *gap)),
    )
    flags = b.block(0x02030000, b.block(0x02030001, b.ints(*element_flags)))
    body = b.block(0x02010000, *head) + flags + data
    if packed == "body":
        return b.block(0x02000000, zlib.compress(body))
    whole = b.block(0x02000000, body)
    return zlib.compress(whole) if packed == "block" else whole


@pytest.fixture
def make_modern():
    """``make(order="<", **options)``: the bytes of a plotfile."""

    def make(order: str = "<", **options: object) -> bytes:
        return modern(Blocks(order), **options)  # type: ignore[arg-type]

    return make


@pytest.fixture
def reference():
    """An independent reader, where it lies beside the repository."""
    path = SHARED / "oracle" / "xpltref.py"
    if not path.is_file():
        pytest.skip("the independent plotfile reader is not beside the repository")
    import importlib.util

    spec = importlib.util.spec_from_file_location("xpltref", path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules["xpltref"] = module
    spec.loader.exec_module(module)
    return module.Xplt


TYPES = {"float": 1, "vec3f": 3, "mat3fs": 6, "mat3fd": 3, "tens4fs": 21, "mat3f": 9}


def random_mesh(rng: np.random.Generator, n: int = 40, domains: int = 3) -> PlotMesh:
    """Elements of several types on random nodes; nothing about them is a real mesh, which the file allows."""
    from febkit.results.xplt import tags

    picks = rng.choice(len(tags.ELEMENT_TYPES), size=domains)
    out, first = [], 1
    for k, code in enumerate(picks):
        name, width = tags.ELEMENT_TYPES[int(code)]
        count = int(rng.integers(1, 6))
        conn = np.array([rng.choice(n, size=width, replace=False) for _ in range(count)])
        ids = np.arange(first, first + count)
        first += count
        label = None if rng.random() < 0.3 else f"domain{k}"
        out.append(PlotDomain(name, int(rng.integers(1, 3)), label, ids, conn))
    facets = {"quad4": rng.integers(0, n, (3, 4)), "tri3": rng.integers(0, n, (2, 3))}
    surfaces = [PlotSurface("mixed", facets), PlotSurface("six", {"tri6": rng.integers(0, n, (4, 6))})]
    return PlotMesh(
        node_ids=rng.permutation(np.arange(1, n + 1)), X=rng.random((n, 3)).astype(np.float32), domains=out,
        surfaces=surfaces, node_sets={"a": rng.integers(0, n, 5), "empty": np.empty(0, int)},
        element_sets={"e": np.array([1])}, parts=[(1, "first"), (2, "second material")],
    )


def random_variables(rng: np.random.Generator) -> list[PlotVariable]:
    """One variable of every section, format and type, in random order."""
    out = []
    for section in ("node", "domain", "surface", "global"):
        formats = {"node": ["node"], "global": ["region"]}.get(section, ["node", "item", "mult", "region"])
        for fmt in formats:
            for kind in (*TYPES, "array", "array vec3f"):
                n = 4 if kind.startswith("array") else 0
                names = tuple(f"c{i}" for i in range(n)) if kind == "array" else ()
                out.append(PlotVariable(f"{section} {fmt} {kind}", section, kind, fmt, n, "P", names))
    return [out[i] for i in rng.permutation(len(out))]


def random_data(rng: np.random.Generator, mesh: PlotMesh, v: PlotVariable) -> dict[int, np.ndarray]:
    """Values for every region; facets padded with zeros as FEBio pads them."""
    if v.section == "global":
        return {0: rng.random(v.values).astype(np.float32)}
    if v.section == "node":
        return {0: rng.random((len(mesh.node_ids), v.values)).astype(np.float32)}
    out = {}
    for i, r in enumerate(mesh.domains if v.section == "domain" else mesh.surfaces):
        rows = r.conn if v.section == "domain" else r.rows()
        n = {"node": len(r.nodes()), "item": len(rows), "mult": rows.size, "region": 1}[v.format]
        a = rng.random((n, v.values)).astype(np.float32)
        if v.format == "mult" and v.section == "surface":
            a[rows.ravel() < 0] = 0
        out[i + 1] = a
    return out


@pytest.fixture
def random_plot():
    """``make(path, seed, states, variables, **options)`` writes a random plotfile; (mesh, variables, data)."""
    from febkit.results.xplt.writer import PlotWriter

    def make(path: Path, seed: int = 0, states: int = 3, some: int | None = None,
             variables: list[PlotVariable] | None = None, **options: object):  # fmt: skip
        rng = np.random.default_rng(seed)
        mesh = random_mesh(rng)
        variables = random_variables(rng)[:some] if variables is None else variables
        data = []
        with PlotWriter(path, mesh, variables, **options) as w:  # type: ignore[arg-type]
            for t in range(states):
                data.append({v.name: random_data(rng, mesh, v) for v in variables})
                w.state(0.25 * t, data[-1], status=t % 3)
        return mesh, variables, data

    return make

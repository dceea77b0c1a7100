"""The pages as tests see them: blocks of code in order, with what is said about each, and the files they may use."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np

import febkit

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
ASIDE = re.compile(r"<!-- not run: (.+?) -->", re.S)
RUN = ("python", "sh")


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, text, line in the page, why it is not run, the output shown below it."""

    language: str
    text: str
    line: int
    aside: str
    output: str | None


def pages() -> list[Path]:
    """All pages that people wrote, the README first."""
    return [ROOT / "README.md", *sorted(p for p in DOCS.rglob("*.md") if "_made" not in p.parts)]


def blocks(text: str) -> list[Block]:
    """Fenced blocks in order; a text block right below one that is run shows its output."""
    from markdown_it import MarkdownIt

    tokens = [t for t in MarkdownIt("commonmark").enable("table").parse(text) if t.level == 0 or t.type == "fence"]
    found = []
    for k, t in enumerate(tokens):
        if t.type != "fence" or t.map is None:
            continue
        before = tokens[k - 1] if k else None
        aside = ASIDE.fullmatch(before.content.strip()) if before is not None and before.type == "html_block" else None
        after = tokens[k + 1] if k + 1 < len(tokens) else None
        shows = after is not None and after.type == "fence" and after.info == "text" and t.info in RUN
        output = after.content if shows and after is not None else None
        found.append(Block(t.info, t.content, t.map[0] + 1, aside[1] if aside else "", output))
    return found


def indented(text: str) -> list[int]:
    """Lines at which blocks of code begin that say no language."""
    from markdown_it import MarkdownIt

    return [t.map[0] + 1 for t in MarkdownIt("commonmark").parse(text) if t.type == "code_block" and t.map]


def furnish(folder: Path) -> None:
    """plug.feb with its results, the same with a stiffer solid, and its mesh as gmsh writes one."""
    names: dict[str, object] = {}
    exec((ROOT / "examples" / "newcomer" / "plug.py").read_text(), names)
    m = names["m"]
    assert isinstance(m, febkit.Model)
    m.write(folder / "plug.feb")
    febkit.solve(m, folder / "plug.xplt", folder / "plug.log")
    write_msh(m, folder / "plug.msh")
    m.materials["cartilage"].solid.E *= 1.5
    m.write(folder / "stiff.feb")
    m.solve(folder / "stiff.xplt")


def write_msh(m: febkit.Model, path: Path) -> None:
    """The plug's mesh with the physical groups "plug", "bottom", "top" and "side"."""
    side = m.faces(where=lambda X: X[:, 0] ** 2 + X[:, 1] ** 2 > 0.998)
    groups = {"bottom": m.faces(z="min"), "top": m.faces(z="max"), "side": side}
    cells = [("hexahedron", m.mesh.blocks[0].conn), *(("quad", g.facets["quad4"]) for g in groups.values())]
    tags = [np.full(len(c), k + 1) for k, (_, c) in enumerate(cells)]
    names = {"plug": np.array([1, 3])} | {n: np.array([k + 2, 2]) for k, n in enumerate(groups)}
    mesh = meshio.Mesh(m.X, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=names)
    meshio.write(path, mesh, "gmsh22", binary=False)

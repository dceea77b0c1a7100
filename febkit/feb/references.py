"""Node sets of surfaces, edges and element sets, for versions that cannot refer to those."""

from __future__ import annotations

import numpy as np

from .document import Tag
from .edit import leaf, listed, walk
from .mesh import floats, ints, label

_KINDS = {"@surface": ("Surface",), "@edge": ("Edge",), "@elem_set": ("Elements", "ElementSet")}


def materialise(root: Tag, mesh: Tag, prefixes: tuple[str, ...]) -> None:
    """References ``node_set="@surface:top"`` with one of the prefixes become node sets of ``mesh``.

    As in FEBio, a node set that has the name after the prefix stands for the reference.
    """
    known = {s.get("name") or s.get("set") or "" for s in mesh if s.name in ("NodeSet", "Nodes")}
    for tag in walk(root):
        ref = tag.get("node_set") or ""
        prefix, _, name = ref.partition(":")
        if prefix not in prefixes:
            continue
        if name not in known:
            known.add(name)
            rows = [leaf("n", id=str(i)) for i in _nodes_of(mesh, prefix, name)]
            mesh.children.append(Tag("NodeSet", {"name": name}, children=rows))
        tag.attrs["node_set"] = name


def _nodes_of(mesh: Tag, prefix: str, name: str) -> list[int]:
    seen: dict[int, None] = {}
    for c in mesh:
        if c.name not in _KINDS[prefix] or c.get("name") != name:
            continue
        if c.name == "ElementSet":
            words = listed(c) or [str(i) for i in ints(c.text, c).tolist()]
            wanted = set(ints(",".join(words), c).tolist())
            for e in mesh.all("Elements"):
                seen |= dict.fromkeys(_row_nodes(e, wanted))
        else:
            seen |= dict.fromkeys(_row_nodes(c, None))
    return list(seen)


def _row_nodes(c: Tag, wanted: set[int] | None) -> list[int]:
    if c.table is not None:
        rows = c.table.values
        if wanted is not None:
            rows = rows[np.isin(c.table.labels, list(wanted))]
        return [int(v) for v in rows.reshape(-1).tolist()]
    return [int(v) for r in c for v in floats(r.text, r) if wanted is None or label(r) in wanted]

"""One load curve per node and degree of freedom, as text: many, so written straight from the arrays."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

from .histories import Handoff

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PREFIX = "driven_"

# version -> section that holds sets and a node set; a condition on a dof and on p; a curve's head, point and foot
_SET = {
    "4.0": ("Mesh", '\t\t<NodeSet name="%s%d">%d</NodeSet>\n'),
    "3.0": ("Mesh", '\t\t<NodeSet name="%s%d"><n id="%d"/></NodeSet>\n'),
    "2.5": ("Geometry", '\t\t<NodeSet name="%s%d"><node id="%d"/></NodeSet>\n'),
}
_CONDITION = {
    "4.0": ('\t\t<bc type="prescribed {what}" node_set="{set}"><dof>{dof}</dof>'
            '<value lc="{lc}">1</value><relative>0</relative></bc>\n',
            '\t\t<bc type="prescribed fluid pressure" node_set="{set}">'
            '<value lc="{lc}">1</value><relative>0</relative></bc>\n'),
    "3.0": ('\t\t<bc type="prescribe" node_set="{set}"><dof>{dof}</dof>'
            '<scale lc="{lc}">1</scale><relative>0</relative></bc>\n',) * 2,
    "2.5": ('\t\t<prescribe bc="{dof}" node_set="{set}"><scale lc="{lc}">1</scale>'
            '<relative>0</relative></prescribe>\n',) * 2,
}
_CURVE = {
    "4.0": ('\t\t<load_controller id="%d" type="loadcurve"><interpolate>LINEAR</interpolate>'
            "<extend>CONSTANT</extend><points>", "<pt>{t},%r</pt>", "</points></load_controller>\n"),
    "2.5": ('\t\t<loadcurve id="%d" type="linear" extend="constant">', "<point>{t},%r</point>",
            "</loadcurve>\n"),
}
_CURVE["3.0"] = _CURVE["4.0"]
# where a missing section goes: before the first of these that is there
_BEFORE = {"Boundary": ("Loads", "Constraints", "LoadData", "Discrete", "Initial", "Step", "Output"),
           "LoadData": ("Step", "Output")}


def curve_sections(given: Handoff, node_ids: Ints, first: int, version: str) -> dict[str, bytes]:
    """Text for the sections: a set per node, a condition per node and dof, a curve per node and dof."""
    parts, dofs = [given.u], ["x", "y", "z"]
    if (p := given.p) is not None:
        parts.append(p[..., None])
        dofs.append("p")
    if (c := given.c) is not None:
        parts.append(c)
        dofs += [f"c{i}" for i in given.solute_ids]
    values = np.concatenate(parts, axis=2)  # (t, n, dof)
    _, n, d = values.shape
    where, row = _SET[version]
    sets = (row * n) % tuple(x for i in node_ids.tolist() for x in (PREFIX, i, i))
    motion, fluid = _CONDITION[version]
    one = "".join((fluid if dof == "p" else motion).format(
        set=f"{PREFIX}%d", dof=dof, lc="%d", what="concentration" if dof[0] == "c" else "displacement") for dof in dofs)
    ids = np.empty((n, d, 2), dtype=np.int64)
    ids[..., 0] = node_ids[:, None]
    ids[..., 1] = first + np.arange(n * d).reshape(n, d)
    # the placeholders are in the order set, lc in all three versions
    boundary = (one * n) % tuple(ids.ravel().tolist())
    return {where: sets.encode(), "Boundary": boundary.encode(),
            "LoadData": _curve_text(values, given.times, first, version)}


def _curve_text(values: Floats, times: Floats, first: int, version: str) -> bytes:
    """All curves, in the order of nodes and dofs; numbers in the fewest digits that read back the same."""
    head, point, foot = _CURVE[version]
    one = head + "".join(point.format(t=repr(float(x))) for x in times) + foot
    t, n, d = values.shape
    by_curve = values.transpose(1, 2, 0).reshape(n * d, t)
    out = []
    for i in range(0, n * d, 5000):
        chunk = by_curve[i:i + 5000]
        flat = np.empty((len(chunk), t + 1), dtype=object)
        flat[:, 0] = list(range(first + i, first + i + len(chunk)))
        flat[:, 1:] = chunk
        out.append((one * len(chunk)) % tuple(flat.ravel().tolist()))
    return "".join(out).encode()


def insert(document: bytes, parts: dict[str, bytes], version: str) -> bytes:
    """Puts text at the end of sections of a .feb document; Boundary and LoadData are made where missing."""
    for name, text in parts.items():
        document = _insert(document, name, text)
    return document


def _insert(document: bytes, name: str, text: bytes) -> bytes:
    tag = name.encode()
    plain = re.sub(rb"<!--.*?-->", lambda m: b" " * len(m.group()), document, flags=re.S)
    close = plain.find(b"</" + tag + b">")
    if close >= 0:
        return document[:close] + text + document[close:]
    empty = re.search(rb"<" + tag + rb"\s*/>", plain)
    whole = b"<" + tag + b">\n" + text + b"\t</" + tag + b">"
    if empty:
        return document[:empty.start()] + whole + document[empty.end():]
    if name not in _BEFORE:
        raise InputError(f"the cell model has no <{name}> section")
    spots = [m.start() for s in _BEFORE[name] if (m := re.search(rb"<" + s.encode() + rb"[\s>/]", plain))]
    at = min(spots, default=plain.rfind(b"</febio_spec>"))
    return document[:at] + whole + b"\n\t" + document[at:]


_HOW = {
    False: 'Boundary of a cell model on its node set "{}". Put an Include tag with the name of this file '
           "behind LoadData of the cell model, from whose materials and load curves its numbers go on.",
    True: "Boundary of a cell model, a load curve per node and degree of freedom. Copy the node sets into "
          "the cell model's own mesh section (FEBio reads one only) and the rest into Boundary and LoadData.",
}


def section_document(parts: dict[str, bytes], node_set: str, version: str) -> bytes:
    """A .feb file that holds nothing but the sections."""
    out = [b'<?xml version="1.0" encoding="UTF-8"?>\n',
           f"<!-- {_HOW['Mesh' in parts or 'Geometry' in parts].format(node_set)} -->\n".encode(),
           f'<febio_spec version="{version}">\n'.encode()]
    order = ("Material", "Mesh", "Geometry", "Boundary", "LoadData")
    for name in sorted(parts, key=order.index):
        out += [f"\t<{name}>\n".encode(), parts[name], f"\t</{name}>\n".encode()]
    return b"".join([*out, b"</febio_spec>\n"])

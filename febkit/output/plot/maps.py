"""Fields, material parameters and data maps by their names: field['displacement'], parameter['fem.material('m').E'],
mesh_data['map']. What is stored, and how, depends on the name.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.solver.solids.registry import field_name
from febkit.solver.values import as_value

from . import laws
from .base import Floats, Part, View, register

if TYPE_CHECKING:
    from febkit.model import MeshData, Model
    from febkit.results.xplt.records import PlotVariable

# FEBio's variables of the degrees of freedom that febkit solves for
FIELDS = {"displacement": ("x", "y", "z"), "fluid pressure": ("p",)}
PARAMETER = re.compile(r"(?:fem\.)?material(?:\[(\d+)\]|\(\s*['\"]?([^'\")]+)['\"]?\s*\))\.(.+)")


def storage(known: PlotVariable, more: tuple[str, ...], model: Model) -> PlotVariable | None:
    """How a variable of this file is stored; None where there is no such thing."""
    name = more[0] if more else ""
    if known.name == "field":
        return replace(known, type="vec3f" if name == "displacement" else "float") if name in FIELDS else None
    if known.name == "parameter":
        return replace(known, section="domain", type="float", format="mult") if _material(model, name) else None
    found = _map(model, name)
    if found is None or found.values is None:
        return None
    attrs = found.spec.attrs
    kind = {"scalar": "float", "vec3": "vec3f", "mat3": "mat3f"}[attrs.get("datatype", "scalar")]
    return replace(known, section="domain", type=kind, format="item" if _flat(attrs) else "mult")


# ---- fields -------------------------------------------------------------------------------------------
def field(view: View, name: str = "") -> Floats | None:
    """Degrees of freedom of all nodes (node, component)."""
    layout = view.state.layout
    if not all(layout.has(c) for c in FIELDS[name]):
        return None
    return view.state.d[:, [layout.column(c) for c in FIELDS[name]]]


# ---- material parameters --------------------------------------------------------------------------------
def _material(model: Model, path: str) -> tuple[str, str] | None:
    """Name of the material and path of the parameter."""
    found = PARAMETER.fullmatch(path.strip())
    names = [m.name or "" for m in model.materials]
    if found is None or (found[1] is not None and int(found[1]) >= len(names)):
        return None
    name = names[int(found[1])] if found[1] is not None else found[2]
    return (name, found[3]) if name in names else None


def parameter(part: Part, path: str = "") -> Floats | None:
    """A parameter of the solid of a part extrapolated to the nodes of its elements (m, n)."""
    found = _material(part.view.model, path)
    if found is None or part.group is None or part.shell or part.material != found[0]:
        return None
    *above, own = found[1].split(".")
    law: Any = part.g.block.solid
    if above and above[0] == "solid" and not hasattr(law, "solid"):  # of a mixture with fluid
        above = above[1:]
    if above and above[0] == "permeability":
        law, above = getattr(part.g.physics, "mixture", None), above
        law = getattr(law, "permeability", None)
        above = above[1:]
    at = laws.below(law, ".".join(above), part.points()) if law is not None else None
    value = getattr(at[0], field_name(own), None) if at is not None else None
    if at is None or value is None or isinstance(value, (tuple, list)):
        return None
    pts = at[1]
    v = part.shaped(np.asarray(as_value(value)(pts.t, pts.X, pts.e), float))
    return np.einsum("ng,eg->en", part.g.element.extrapolation, v)


# ---- data maps ------------------------------------------------------------------------------------------
def _map(model: Model, name: str) -> MeshData | None:
    return next((d for d in model.mesh_data if d.kind == "element" and d.name == name), None)


def _flat(attrs: Mapping[str, str]) -> bool:
    """One value an element, not one at each of its nodes: tensors, and what the file says to be such."""
    return attrs.get("datatype") == "mat3" or attrs.get("format", "").upper() == "ITEM"


def mesh_data(part: Part, name: str = "") -> Floats | None:
    """Element data of the model at the nodes of elements (m, n, component), or (m, component) where they are flat."""
    from febkit.model.sets import element_ids

    data = _map(part.view.model, name)
    if data is None or data.values is None or data.items is None:
        return None
    ids = element_ids(part.view.model.mesh, data.set, data.where)[np.asarray(data.items) - 1]
    row = {int(i): k for k, i in enumerate(ids)}
    mine = [row.get(int(i), -1) for i in part.mesh.element_ids]
    if max(mine, default=-1) < 0:
        return None
    v = np.where((np.array(mine) >= 0)[:, None], data.values[mine], 0.0)
    if _flat(data.spec.attrs):
        return v
    each = 3 if data.spec.attrs.get("datatype") == "vec3" else 1
    return np.broadcast_to(v.reshape(len(v), -1, each), (len(v), part.mesh.conn.shape[1], each))


register("field", field, more=True)
register("parameter", parameter, more=True)
register("mesh_data", mesh_data, more=True)

"""<load_controller type="PID">: a number that follows what has been solved."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from febkit.model import InputError, LoadController
from febkit.solver.feedback import Pid

if TYPE_CHECKING:
    from .context import Context

NODE = re.compile(r"fem\.mesh\.node(?:\[(\d+)\]|\.fromId\((\d+)\))\.(?:position\.([xyz])|(\w+))")
TAGS = frozenset({"var", "target", "Kp", "Ki", "Kd"})


def pid(ctx: Context, spec: LoadController) -> Pid:
    """The controller, which is among what acts. What it measures is a position or an unknown of a node."""
    c = spec.spec
    ctx.check_tags(c, TAGS)
    leaf = c.need("var")
    found = NODE.fullmatch("".join(leaf.text.split()))
    if found is None:
        ctx.refuse(f"<var>{leaf.text.strip()}</var> of a PID controller, which measures nodes alone,", leaf.where)
        return Pid(c.name or "", lambda state: 0.0)
    place, label, axis, dof = found.groups()
    ids = ctx.model.mesh.node_ids
    at = np.array([int(place)]) if place else np.flatnonzero(ids == int(label))
    if not len(at) or at[0] >= len(ids):
        said = f"{len(ids)} nodes, numbered from 0" if place else f"no node {label}"
        raise InputError(f"<var>: there is {said}", leaf.where)
    n = int(at[0])
    if axis:
        k = "xyz".index(axis)
        made = Pid(c.name or "", lambda state: float(state.x[n, k]))
    else:
        column = ctx.column(dof, c)
        made = Pid(c.name or "", lambda state: float(state.d[n, column]))
    made.target, made.Kp, made.Ki, made.Kd = (c.float(t, 0.0) for t in ("target", "Kp", "Ki", "Kd"))
    ctx.feedback.append(made)
    return made

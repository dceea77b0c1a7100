"""<RVE> of a micro-material: the representative volume in another file, lowered like any model."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import Component, InputError, Model
from febkit.model.sets import node_indices
from febkit.solver import elements
from febkit.solver.fields import DISPLACEMENT
from febkit.solver.problem import Problem
from febkit.solver.rve import Rve

from .context import Context

TYPES = {"displacement": 0, "periodic linear constraints": 1, "0": 0, "1": 1, "2": 2}


def volume(ctx: Context, leaf: Component) -> Any:
    """The volume that ``leaf`` names, scaled, with the nodes of its boundary; None where it is refused."""
    spec = ctx.owners[id(leaf)]
    model = ctx.model.nested.get(leaf.text.strip())
    if model is None:
        raise InputError(f'{leaf.what}: there is no file "{leaf.text.strip()}" in the folder of the model', leaf.where)
    if spec.choice("rve_type", TYPES, 0) != 0:
        ctx.refuse("<rve_type> other than 0 (displacements) of a micro-material", spec.need("rve_type").where)
        return None
    problem = ctx.lower(model)
    acts = (problem.common, *problem.steps)
    acting = any(s.loads or s.body_loads or s.contacts or s.constraints or s.connectors or s.attached for s in acts)
    plain = all(b.physics.fields == (DISPLACEMENT,) and b.element in elements.VOLUMES for b in problem.blocks)
    what = f'a representative volume ("{leaf.text.strip()}")'
    if acting or problem.bodies or not plain or len(problem.steps) != 1:
        ctx.refuse(f"{what} of other than solids in one step, under no loads", leaf.where)
        return None
    X = model.mesh.X
    problem.X = X.mean(axis=0) + spec.float("scale", 1.0) * (X - X.mean(axis=0))
    made = Rve(problem, _boundary(model, problem, spec))
    if made.grows:
        ctx.refuse(f"{what} of materials whose memory grows", leaf.where)
        return None
    return made


def _boundary(model: Model, problem: Problem, spec: Component) -> NDArray[np.int64]:
    """The nodes of <bc_set>, else all those on faces of one element alone."""
    if spec.str("bc_set"):
        return np.unique(node_indices(model.mesh, spec.str("bc_set"), spec.need("bc_set").where))
    faces: dict[tuple[int, ...], list[int]] = {}
    for b in problem.blocks:
        for _, local in elements.get(b.element).facets:
            for nodes in b.conn[:, list(local)].tolist():
                faces.setdefault(tuple(sorted(nodes)), []).extend(nodes)
    alone = [n for key, nodes in faces.items() if len(nodes) == len(key) for n in nodes]
    return np.unique(np.array(alone, dtype=np.int64))

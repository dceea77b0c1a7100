"""Names and numbers that refer to something: sets, parts, materials, curves, maps."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from febkit.model import Component, Model, Step, Where
from febkit.model.sets import element_ids, map_items, missing, node_indices, surface
from febkit.model.source import InputError
from febkit.model.values import TRUE, near
from febkit.record import value_record

from .findings import Finding

BODIES = ("rb", "body_a", "body_b", "rbA", "rbB")
FIELDS = ("boundary", "loads", "contact", "constraints", "rigid", "initial", "adaptors")
REFERENCE = re.compile(r"""fem\.material\(\s*['"]([^'"]+)['"]\s*\)""")


def check(model: Model) -> Iterator[Finding]:
    yield from materials(model)
    yield from domains(model)
    yield from sets(model)
    yield from curves(model)
    known = Names.of(model)
    for step in (model.common, *model.steps):
        yield from stage(model, step, known)
    yield from maps(model, known)
    yield from output(model)


def materials(model: Model) -> Iterator[Finding]:
    seen: dict[str, Component] = {}
    for i, m in enumerate(model.materials, 1):
        if m.id != i:
            message = f'material "{m.name}" has id {m.id}; ids count from 1 without gaps ({i} here)'
            yield Finding("error", message, m.where)
        if m.name in seen:
            yield Finding("error", f'a second material named "{m.name}"', m.where)
        seen[m.name or ""] = m
    used = {d.material for d in model.domains} | set(_named_in_formulas(model))
    for m in model.materials:
        if m.name not in used and m.type != "rigid body":  # a rigid body need not have a mesh
            yield Finding("warning", f'material "{m.name}" belongs to no domain', m.where)


def _named_in_formulas(model: Model) -> Iterator[str]:
    """Materials whose parameters a formula reads: they need no domain, they hold numbers or histories."""
    trees = [*model.materials, *(c.spec for c in model.controllers), *(d.spec for d in model.mesh_data)]
    for step in (model.common, *model.steps):
        trees += [c for field in FIELDS for c in getattr(step, field)]
        trees += [] if step.control is None else [step.control]
    while trees:
        c = trees.pop()
        if "fem.material" in c.text:
            yield from REFERENCE.findall(c.text)
        trees += c.children


def domains(model: Model) -> Iterator[Finding]:
    names = {m.name for m in model.materials}
    blocks = {b.name for b in model.mesh.blocks}
    done: set[str] = set()
    for d in model.domains:
        if d.block not in blocks:
            message = f'domain "{d.block}": there are no <Elements> of that name{near(d.block, blocks)}'
            yield Finding("error", message, d.where)
        if d.material not in names:
            hint = near(d.material, [n or "" for n in names])
            message = f'domain "{d.block}": there is no material "{d.material}"{hint}'
            yield Finding("error", message, d.where)
        if d.block in done:
            yield Finding("error", f'domain "{d.block}" is defined twice', d.where)
        done.add(d.block)
    for b in model.mesh.blocks:
        if b.name not in done:
            yield Finding("error", f'part "{b.name}" has no domain, so no material', b.where)


def sets(model: Model) -> Iterator[Finding]:
    mesh = model.mesh
    ids = np.sort(np.concatenate([b.ids for b in mesh.blocks])) if mesh.blocks else np.zeros(0, np.int64)
    for e in mesh.element_sets.values():
        missing = e.elements[~np.isin(e.elements, ids)]
        if len(missing):
            message = f'element set "{e.name}" refers to element {missing[0]}, which does not exist'
            yield Finding("error", message, e.where)
    for p in mesh.surface_pairs.values():
        for s in (p.primary, p.secondary):
            if s not in mesh.surfaces:
                yield Finding("error", f'surface pair "{p.name}": there is no surface "{s}"', p.where)
    for name, parts in mesh.part_lists.items():
        for part in parts:
            try:
                element_ids(mesh, part)
            except InputError:
                yield Finding("error", f'part list "{name}": there is no part "{part}"', Where(model.file))
    sizes = [(s.name, len(s.nodes), s.where) for s in mesh.node_sets.values()]
    sizes += [(f.name, sum(len(k) for k in f.facets.values()), f.where) for f in mesh.surfaces.values()]
    for name, size, where in sizes:
        if not size:
            yield Finding("warning", f'the set "{name}" is empty', where)


def curves(model: Model) -> Iterator[Finding]:
    for i, c in enumerate(model.controllers, 1):
        if c.id != i:
            message = f"load controller {c.id}: ids count from 1 without gaps ({i} here)"
            yield Finding("error", message, c.where)
        if c.type == "loadcurve" and not c.points:
            yield Finding("error", f"load curve {c.id} has no points", c.where)
        times = [t for t, _ in c.points]
        if any(b < a for a, b in pairwise(times)):
            yield Finding("warning", f"load curve {c.id}: times do not increase", c.where)


def stage(model: Model, step: Step, known: Names) -> Iterator[Finding]:
    for field in FIELDS:
        for c in getattr(step, field):
            yield from references(model, c)
            yield from below(known, c)
    if step.control is not None:
        yield from below(known, step.control)


def references(model: Model, c: Component) -> Iterator[Finding]:
    """The sets a condition names."""
    mesh = model.mesh
    for attr, v in c.attrs.items():
        try:
            if attr == "node_set":
                node_indices(mesh, v)
            elif attr == "elem_set":
                element_ids(mesh, v)
            elif attr == "surface":
                surface(mesh, v)
            elif attr == "edge" and v not in mesh.edges:
                raise missing("edge", v, mesh.edges, None)
            elif attr == "surface_pair" and v not in mesh.surface_pairs:
                raise missing("surface pair", v, mesh.surface_pairs, None)
        except InputError as e:
            yield Finding("error", f'<{c.tag} type="{c.type}">: {e.message}', c.where)


@value_record
class Names:
    """What a parameter may refer to."""

    curves: frozenset[int]
    maps: frozenset[str]
    bodies: frozenset[str]  # names and numbers of rigid materials

    @classmethod
    def of(cls, model: Model) -> Names:
        rigid = [m for m in model.materials if m.type == "rigid body"]
        bodies = frozenset(m.name or "" for m in rigid) | {str(m.id) for m in rigid}
        return cls(frozenset(c.id for c in model.controllers), frozenset(d.name for d in model.mesh_data), bodies)


def below(known: Names, c: Component) -> Iterator[Finding]:
    """Curves, maps and rigid bodies anywhere in a tree, and words where FEBio wants 0 or 1."""
    if c.text.lower() in TRUE:
        yield Finding("warning", f'<{c.tag}>: FEBio 4.11 reads "{c.text}" as 0, febkit as 1; write 1', c.where)
    try:
        lc = c.lc
    except InputError as e:
        yield Finding("error", e.message, c.where)
        lc = None
    if lc is not None and lc not in known.curves:
        yield Finding("error", f'<{c.tag} lc="{lc}">: there is no load controller {lc}', c.where)
    for name in (x.strip() for x in c.text.split(",")) if c.type == "map" and c.text else ():
        if name not in known.maps:
            message = f'<{c.tag} type="map">: there is no map "{name}" in <MeshData>{near(name, known.maps)}'
            yield Finding("error", message, c.where)
    if c.tag in BODIES and not c.children and c.text and "," not in c.text and c.text not in known.bodies:
        message = f'<{c.tag}>: there is no rigid body material "{c.text}"{near(c.text, known.bodies)}'
        yield Finding("error", message, c.where)
    for x in c.children:
        yield from below(known, x)


def maps(model: Model, known: Names) -> Iterator[Finding]:
    mesh = model.mesh
    for m in (*model.materials, *model.discrete):
        yield from below(known, m)
    for d in model.discrete:
        name = d.attrs.get("discrete_set")
        if name is not None and name not in mesh.discrete_sets:
            yield Finding("error", f'<{d.tag}>: there is no discrete set "{name}"', d.where)
    for r in model.mesh_data:
        try:
            map_items(mesh, r)
        except InputError as e:
            yield Finding("error", e.message, r.where)


def output(model: Model) -> Iterator[Finding]:
    for v in model.output.plot:
        if v.surface is not None and v.surface not in model.mesh.surfaces:
            yield Finding("error", f'plot variable "{v.type}": there is no surface "{v.surface}"', v.where)
    for e in model.output.log:
        if e.set is None:
            continue
        try:
            if e.kind == "node_data":
                node_indices(model.mesh, e.set)
            elif e.kind == "element_data":
                element_ids(model.mesh, e.set)
        except InputError as error:
            yield Finding("error", f"<{e.kind}>: {error.message}", e.where)

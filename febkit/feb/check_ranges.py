"""Parameters against the values that FEBio admits (:mod:`febkit.model.ranges`), and what several must be together."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from febkit.model import Component, InputError, Model, values
from febkit.model.ranges import WORDS, Range, of

from .features import anywhere
from .findings import Finding


def check(model: Model) -> Iterator[Finding]:
    """Constants outside their range are errors, as in FEBio; values of maps, which it does not look at, warnings."""
    for c in (*model.materials, *(d for d in model.discrete if d.tag == "discrete_material")):
        yield from component(model, c)
        yield from bulk(c, False)
    for step in model.steps:
        if step.control is not None:
            yield from parameters(model, step.control, "(control)", "<Control>")
            for solver in step.control.all("solver"):
                yield from parameters(model, solver, "(solver)", "<solver>")
                for c in solver:
                    yield from component(model, c)


ORTHOTROPIC = frozenset(("orthotropic elastic", "Fung orthotropic", "Fung-ortho-compressible"))


def orthotropic(c: Component, name: str) -> Iterator[Finding]:
    """v_ij <= sqrt(E_i / E_j), where these are constants."""
    for i, j in ("12", "23", "31"):
        leaves = [c.child(tag) for tag in (f"v{i}{j}", f"E{i}", f"E{j}")]
        if any(x is None or x.type or not values.spells_number(x.text) for x in leaves):
            continue
        v, a, b = (float(x.text) for x in leaves if x is not None)
        if a > 0 and b > 0 and v > math.sqrt(a / b):
            message = f"<v{i}{j}> of {name} must be at most sqrt(E{i}/E{j}) = {math.sqrt(a / b):.6g}, not {v:g}"
            yield Finding("error", message, leaves[0].where if leaves[0] is not None else c.where)


def bulk(c: Component, within: bool) -> Iterator[Finding]:
    """An uncoupled material that is no part of another has the bulk modulus of the whole: it must be positive."""
    known = anywhere().get(c.type or c.tag, frozenset())
    uncoupled = "k" in known and "pressure_model" in known
    if uncoupled and not within:
        k = c.child("k")
        if k is None:
            yield Finding("error", f"{c.what} lacks <k>, the bulk modulus of the whole", c.where)
        elif not k.type and values.spells_number(k.text) and float(k.text) == 0:
            message = f"<k> of {c.type or c.tag}, the bulk modulus of the whole, must be more than 0"
            yield Finding("error", message, k.where)
    for x in c:
        if x.type or x.children:
            yield from bulk(x, uncoupled)


def component(model: Model, c: Component) -> Iterator[Finding]:
    """A type and all below it."""
    name = c.type or c.tag  # a child without a type is of the one its tag names
    yield from parameters(model, c, name, name)
    if name in ORTHOTROPIC:
        yield from orthotropic(c, name)
    for x in c:
        if x.children or x.type:
            yield from component(model, x)


def parameters(model: Model, c: Component, type_: str, label: str) -> Iterator[Finding]:
    admitted = of(type_)
    for x in c if admitted else ():
        r = admitted.get(x.tag)
        if r is None:
            continue
        kind = x.type or "const"
        if kind == "map":
            yield from mapped(model, x, r, label)
        elif kind in ("const", "vector"):
            yield from constant(x.child("const") or x, r, label)


def constant(x: Component, r: Range, label: str) -> Iterator[Finding]:
    """A number or several; with a load curve the number counts too, as in FEBio."""
    words = WORDS.get(x.tag, ())
    if x.text.strip().lower() in words:
        given = [float(words.index(x.text.strip().lower()))]
    else:
        listed = x.text.replace(",", " ").split()
        if not listed or not all(map(values.spells_number, listed)):
            return  # a formula
        try:
            given = list(x.as_floats())
        except InputError as e:
            yield Finding("error", e.message, x.where)
            return
    if not all(map(r.holds, given)):
        yield Finding("error", f"<{x.tag}> of {label} must be {r.said}, not {x.text.strip()}", x.where)


def mapped(model: Model, x: Component, r: Range, label: str) -> Iterator[Finding]:
    name = (x.child("map") or x).text.strip()
    for data in model.mesh_data:
        if data.name == name and data.values is not None and data.items is not None:
            outside = [v for v in np.unique(data.values).tolist() if v == v and not r.holds(v)]
            if outside:
                message = f'<{x.tag}> of {label} must be {r.said}; the map "{name}" holds {outside[0]:g}'
                yield Finding("warning", message, data.where)

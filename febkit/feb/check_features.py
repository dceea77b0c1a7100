"""Types, parameters and attributes against FEBio's tables (:mod:`.features`)."""

from __future__ import annotations

from collections.abc import Iterator

from febkit.model import Component, Model, Step
from febkit.model.source import InputError
from febkit.model.values import near

from .features import anywhere, table
from .findings import Finding

# kinds of the table by the tag of a condition, and the attributes it may carry
KINDS = {"bc": "bc", "nodal_load": "nodal_load", "surface_load": "surface_load", "edge_load": "load",
         "body_load": "body_load", "contact": "contact", "constraint": "constraint", "ic": "ic",
         "rigid_bc": "bc", "rigid_ic": "ic", "rigid_load": "load", "rigid_connector": "constraint",
         "mesh_adaptor": "mesh_adaptor", "material": "material", "discrete_material": "discrete_material"}
ATTRS = {"bc": {"node_set", "surface", "surface_pair"}, "nodal_load": {"node_set"},
         "surface_load": {"surface"}, "edge_load": {"edge"}, "body_load": {"elem_set"},
         "contact": {"surface_pair", "surface"},
         "constraint": {"surface", "elem_set", "node_set"}, "ic": {"node_set"}, "rigid_bc": set(),
         "rigid_ic": set(), "rigid_load": set(), "rigid_connector": set(), "mesh_adaptor": {"elem_set"}}
FIELDS = {"boundary": ("bc",), "loads": ("nodal_load", "surface_load", "edge_load", "body_load"),
          "contact": ("contact",), "constraints": ("constraint",), "initial": ("ic",),
          "adaptors": ("mesh_adaptor",),
          "rigid": ("rigid_bc", "rigid_ic", "rigid_load", "rigid_connector")}
# types of a value, not of a component
VALUES = frozenset(("math", "map", "const", "local", "vector", "angles", "spherical", "cylindrical", "user",
                    "polar", "step", "linear", "loadcurve"))
FORMULA_LIMIT = 511  # FEBio 4.11 copies a formula without its blanks into 512 characters


def check(model: Model) -> Iterator[Finding]:
    """Unknown sections, types, parameters and attributes, and formulas that do not parse."""
    old = model.version not in ("3.0", "4.0")
    for u in model.unknown:
        if u.tag not in ("Globals", "Code"):
            yield Finding("error", f"<{u.tag}> is no section of a .feb file", u.where)
    for c in (*model.materials, *(d for d in model.discrete if d.tag == "discrete_material")):
        yield from component(c, KINDS.get(c.tag), old)
    for step in (model.common, *model.steps):
        yield from stage(step, old)
    for lc in model.controllers:
        yield from component(lc.spec, "load_controller", old)
    known = frozenset().union(*table()["domain"].values())
    for d in model.domains:
        if d.type is not None and d.type not in table()["domain"]:
            yield Finding("error", f'domain "{d.block}": unknown type "{d.type}"', d.where)
        for c in d.spec.children if d.spec is not None else ():
            if c.tag not in known:
                yield Finding("error", f'domain "{d.block}": <{c.tag}> is not a parameter of it', c.where)
    for v in model.output.plot:
        known_plots = table()["plot"]
        if v.type.partition("[")[0] not in known_plots:
            yield Finding("warning", f'unknown plot variable "{v.type}"{near(v.type, known_plots)}', v.where)


def stage(step: Step, old: bool) -> Iterator[Finding]:
    for field, tags in FIELDS.items():
        for c in getattr(step, field):
            if c.tag not in tags:
                message = f"<{c.tag}> does not belong there; expected {', '.join(tags)}"
                yield Finding("error", message, c.where)
                continue
            if c.type is None:
                yield Finding("error", f'<{c.tag}> lacks type="..."', c.where)
                continue
            strange = sorted(set(c.attrs) - ATTRS[c.tag])
            if strange and not old:
                message = f'<{c.tag} type="{c.type}"> has an unknown attribute {strange[0]}='
                yield Finding("error", message, c.where)
            yield from component(c, KINDS[c.tag], old)
    if step.control is not None:
        yield from control(step.control, old)


def control(c: Component, old: bool) -> Iterator[Finding]:
    known = frozenset().union(*table()["analysis"].values())
    for p in c:
        if p.tag == "solver":
            yield from component(p, "solver", old)
        elif p.tag not in known:
            yield Finding("warning" if old else "error",
                          f"<{p.tag}> is not a parameter of <Control>{near(p.tag, known)}", p.where)


def component(c: Component, kind: str | None, old: bool) -> Iterator[Finding]:
    """A type, its parameters, and the properties below it."""
    yield from formulas(c)
    types = anywhere() if kind is None else table()[kind]
    if c.type is None or (c.type in VALUES and c.type not in types):
        for x in c.children:
            yield from component(x, None, old)
        return
    known = types.get(c.type)
    if known is None:
        yield Finding("error", f'unknown <{c.tag} type="{c.type}">{near(c.type, types)}', c.where)
        return
    for x in c.children:
        if x.tag not in known:
            yield Finding("warning" if old else "error",
                          f'<{x.tag}> is not a parameter of {c.type}{near(x.tag, known)}', x.where)
        yield from component(x, None, old) if x.type or x.children else formulas(x)


def formulas(c: Component) -> Iterator[Finding]:
    if (c.type == "math" and c.text and not c.children) or (c.tag == "math" and c.text):
        from febkit.model.math import (
            compile as compile_formula,  # the parser is paid for where there is a formula
        )

        text = c.text
    else:
        return
    for part in text.split(",") if "(" not in text else [text]:
        try:
            compile_formula(part, None)
        except InputError as e:
            yield Finding("error", e.message, c.where)
    if len("".join(text.split())) > FORMULA_LIMIT:
        yield Finding("warning", f"a formula of more than {FORMULA_LIMIT} characters: FEBio 4.11 overruns "
                      "its buffer (febkit does not)", c.where)

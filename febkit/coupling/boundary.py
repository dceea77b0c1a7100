"""A hand-off as boundary conditions: a cell model driven by it, or a .feb section, in 4.0, 3.0 and 2.5.

Forms: "math" and "parameters" (see :mod:`.formula`) carry a series in four conditions and one for each solute;
"curves" has one load curve per node and degree of freedom, which every version reads and an overlay needs. "auto"
takes the shortest that the version and FEBio's parser can hold.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.files import put
from febkit.model import Component, InputError, LoadController, Model, NodeSet, Step, as_record
from febkit.model.sets import node_indices
from febkit.model.species import solutes

from .curves import curve_sections, insert, section_document
from .formula import LONGEST, Reference, referring, spelled_out
from .histories import Handoff

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FORMS = ("auto", "math", "parameters", "curves")
VERSIONS = ("4.0", "3.0", "2.5")
_MOTION = {"zero displacement", "prescribed displacement", "fix", "prescribe", "normal displacement",
           "prescribed deformation", "prescribed deformation 2O"}
_PRESSURE = {"zero fluid pressure", "prescribed fluid pressure", "fluid pressure"}
_CONCENTRATION = {"zero concentration", "prescribed concentration"}


@dataclass(frozen=True, slots=True, eq=False)
class Driven:
    """A cell model with a hand-off on it. ``model`` lacks the conditions where ``form`` is "curves"
    (:func:`write` puts these in); ``said`` tells what was replaced and added."""

    model: Model
    handoff: Handoff
    node_set: str
    nodes: Ints
    form: str
    said: tuple[str, ...]


def pick_form(form: str, given: Handoff, version: str) -> str:
    """The form for a version. Raises InputError where the one asked for cannot hold the hand-off."""
    if form not in FORMS or version not in VERSIONS:
        raise InputError(f"forms are {', '.join(FORMS)} and versions {', '.join(VERSIONS)}; "
                         f"not {form} in {version}")
    if form == "curves":
        return form
    why = None
    if version != "4.0":
        why = f"version {version} has no formulas on boundary values: it needs a load curve per node and dof"
    elif given.motion is None:
        why = "an overlay is no polynomial: it needs a load curve per node and dof"
    if why:
        if form == "auto":
            return "curves"
        raise InputError(f'form "{form}": {why}; use curves')
    longest = max(len(spelled_out(given.times, c, given.origin)) for _, c in _components(given))
    if longest <= LONGEST:
        return "math" if form == "auto" else form
    if form == "math":
        raise InputError(f"the longest expression has {longest} characters, and FEBio crashes beyond 511: "
                         "use the form parameters or curves")
    return "parameters"


def _components(given: Handoff) -> list[tuple[str, Floats]]:
    """("x", (t, terms)), ("y", ...), ("z", ...) and, where they are handed off, ("p", ...), ("c1", ...), ..."""
    assert given.motion is not None
    out = [(d, given.motion[:, :, k]) for k, d in enumerate("xyz")]
    if given.fluid is not None:
        out.append(("p", given.fluid))
    if given.concentration is not None:
        out += [(f"c{n}", given.concentration[:, :, k]) for k, n in enumerate(given.solute_ids)]
    return out


def drive(model: Model, given: Handoff, nodes: Ints, *, node_set: str | None = None, form: str = "auto",
          version: str = "4.0", must_points: bool = True) -> Driven:
    """The cell model driven on ``nodes`` (0-based, in the order of ``given.X``) by a hand-off.

    Solutes go by name: each of the cell model's needs one in the driving data. Conditions on what is handed off that
    lie on these nodes are replaced; one that reaches beyond them is an InputError. Time steppers get must points at
    the hand-off's times.
    """
    model = as_record(model)
    mixture = model.module in ("biphasic", "biphasic-FSI", "multiphasic", "solute")
    if given.wet and not mixture:
        given = given.without_pressure()
    given = with_solutes(given, model)
    form = pick_form(form, given, version)
    name, model, said = _named_set(model, nodes, node_set)
    model, gone = _without_old(model, nodes, given)
    said += gone
    if must_points:
        model, told = with_must_points(model, given.times)
        said += told
    said += _ends(model, given.times)
    if form != "curves":
        model = _with_conditions(model, given, name, form)
    return Driven(model, given, name, nodes, form, tuple(said))


def _named_set(model: Model, nodes: Ints, wanted: str | None) -> tuple[str, Model, list[str]]:
    """The name of a node set with just these nodes; added to the mesh where there is none."""
    sets = model.mesh.node_sets
    key = np.sort(nodes)
    if wanted is not None and wanted in sets and np.array_equal(np.sort(sets[wanted].nodes), key):
        return wanted, model, []
    for name, s in sets.items():
        if wanted is None and len(s.nodes) == len(key) and np.array_equal(np.sort(s.nodes), key):
            return name, model, []
    base = (wanted or "driven").replace("@", "").replace(":", "_")
    name, n = base, 1
    while name in sets:
        n += 1
        name = f"{base}_{n}"
    mesh = replace(model.mesh, node_sets={**sets, name: NodeSet(name, nodes)})
    return name, replace(model, mesh=mesh), [f'added the node set "{name}" with {len(nodes)} nodes']


def with_solutes(given: Handoff, model: Model) -> Handoff:
    """The hand-off with the solutes of a cell model, in its order and by its ids (dofs c1, c2, ...).

    Driving data without concentrations drive motion and pressure alone. Raises InputError where they hold some solutes
    but not all that the cell model has.
    """
    model = as_record(model)
    if model.module not in ("multiphasic", "solute") or not given.solutes:
        return given.of_solutes(())
    own = solutes(model)
    return replace(given.of_solutes([s.name for s in own]), solute_ids=tuple(s.id for s in own))


def _without_old(model: Model, nodes: Ints, given: Handoff) -> tuple[Model, list[str]]:
    """The model without the conditions that the hand-off takes the place of."""
    said: list[str] = []

    def kept(step: Step) -> Step:
        left = [c for c in step.boundary if not _replaced(model, c, nodes, given, said)]
        return step if len(left) == len(step.boundary) else replace(step, boundary=tuple(left))

    return replace(model, common=kept(model.common), steps=tuple(kept(s) for s in model.steps)), said


def _replaced(model: Model, c: Component, nodes: Ints, given: Handoff, said: list[str]) -> bool:
    kind = c.type or ""
    handed = kind in _MOTION or (given.wet and kind in _PRESSURE) or (bool(given.solutes) and kind in _CONCENTRATION)
    if not handed:
        return False
    ref = c.attrs.get("node_set") or ("@surface:" + c.attrs["surface"] if "surface" in c.attrs else "")
    if not ref:
        return False
    own = np.isin(node_indices(model.mesh, ref, c.where), nodes)
    if not own.any():
        return False
    if not own.all():
        raise InputError(f'<bc type="{kind}"> on "{ref}" holds {own.sum()} of the driven nodes and '
                         f"{(~own).sum()} others: split or remove it, or drive another set", c.where)
    said.append(f'replaced <bc type="{kind}"> on "{ref}"')
    return True


def _ends(model: Model, times: Floats) -> list[str]:
    """A sentence where the cell model and the hand-off end at different times."""
    controls = [s.control for s in model.steps if s.control is not None]
    counts = [(c.int("time_steps", 10), c.float("step_size", 0.1), c.float("final_time", 0.0)) for c in controls]
    end, last = sum(final if n < 0 else n * dt for n, dt, final in counts), float(times[-1])
    if not controls or np.isclose(end, last, rtol=1e-6):
        return []
    if end < last:
        return [f"the cell model ends at t = {end:g}, the hand-off at {last:g}: for more of it, give the cell model's "
                "<Control> more time_steps (templates: --set times)"]  # fmt: skip
    return [f"the hand-off ends at t = {last:g}, the cell model at {end:g}: from there on its surface stays as it is"]


# ---- must points ---------------------------------------------------------------------------------


def with_must_points(model: Model, times: Floats) -> tuple[Model, list[str]]:
    """Adds the hand-off's times to the must points (the load curve of dtmax) of every time stepper."""
    said: list[str] = []
    controllers = list(model.controllers)
    steps, fixed, adapted = [], [], 0
    for n, step in enumerate(model.steps, 1):
        if step.control is None:
            steps.append(step)
            continue
        stepper = step.control.child("time_stepper")
        if stepper is None:
            fixed.append(n)
            steps.append(step)
            continue
        stepper, controllers = _stepper_with(stepper, step.control, times, controllers)
        steps.append(replace(step, control=_swap(step.control, stepper)))
        adapted += 1
    if adapted:
        said.append(f"must points at {len(times)} times")
    if fixed:
        said.append(f"steps of fixed size (step {', '.join(map(str, fixed))}) have no must points: "
                    "see that they meet the times")
    return replace(model, controllers=tuple(controllers), steps=tuple(steps)), said


def _stepper_with(stepper: Component, control: Component, times: Floats,
                  controllers: list[LoadController]) -> tuple[Component, list[LoadController]]:
    old = stepper.child("dtmax")
    lc = None if old is None else old.lc
    held = next((k for k, c in enumerate(controllers) if c.id == lc and c.points), None)
    later = times[times > 0] if (times > 0).any() else times
    if held is not None:
        points = np.array(controllers[held].points)
        union = _union(points[:, 0], later)
        right = np.clip(np.searchsorted(points[:, 0], union, side="left"), 0, len(points) - 1)
        rows = list(zip(union.tolist(), points[right, 1].tolist()))
        controllers = list(controllers)
        controllers[held] = replace(controllers[held], points=tuple(rows),
                                    spec=_curve_spec(controllers[held].spec, rows))
        return stepper, controllers
    longest = old.as_float() if old is not None and lc is None else 0.0
    longest = longest or control.float("step_size", 0.1)
    union = _union(np.array([0.0]), later)
    curve = load_curve(_next_id(controllers), "must points", union, np.full(len(union), longest), "STEP")
    dtmax = Component("dtmax", text="1" if old is None else old.text or "1", attrs={"lc": str(curve.id)})
    left = tuple(c for c in stepper.children if c.tag != "dtmax")
    return replace(stepper, children=(*left, dtmax)), [*controllers, curve]


def _union(a: Floats, b: Floats) -> Floats:
    """Times of both; those nearer than 1e-9 of the span count as one."""
    t = np.unique(np.concatenate([a, b]))
    keep = np.concatenate([[True], np.diff(t) > 1e-9 * max(t[-1] - t[0], 1e-300)])
    return np.asarray(t[keep])


def _swap(control: Component, stepper: Component) -> Component:
    swapped = tuple(stepper if c.tag == "time_stepper" else c for c in control.children)
    return replace(control, children=swapped)


def _curve_spec(spec: Component, rows: Iterable[tuple[float, float]]) -> Component:
    points = Component("points", children=tuple(Component("pt", text=f"{t!r},{v!r}") for t, v in rows))
    left = tuple(c for c in spec.children if c.tag != "points")
    return replace(spec, children=(*left, points))


def _next_id(controllers: Iterable[LoadController]) -> int:
    return max((c.id for c in controllers), default=0) + 1


def load_curve(number: int, name: str, times: Floats, values: Floats,
               interpolate: str = "LINEAR") -> LoadController:
    """A load curve, constant outside its points."""
    rows = [(float(t), float(v)) for t, v in zip(times, values)]
    spec = Component("load_controller", "loadcurve", name, number, children=(
        Component("interpolate", text=interpolate), Component("extend", text="CONSTANT")))
    return LoadController(number, "loadcurve", _curve_spec(spec, rows), name, tuple(rows))


# ---- the conditions ------------------------------------------------------------------------------


def _with_conditions(model: Model, given: Handoff, node_set: str, form: str) -> Model:
    conditions, references = conditions_of(given, node_set, form)
    taken = {m.name for m in model.materials}
    clash = [r.name for r in references if r.name in taken]
    if clash:
        raise InputError(f'the cell model already has a material "{clash[0]}": it is driven already')
    first = max((m.id or k for k, m in enumerate(model.materials, 1)), default=0) + 1
    materials, curves = helpers(references, given.times, first, _next_id(model.controllers))
    common = replace(model.common, boundary=(*model.common.boundary, *conditions))
    return replace(model, common=common, materials=(*model.materials, *materials),
                   controllers=(*model.controllers, *curves))


def conditions_of(given: Handoff, node_set: str, form: str) -> tuple[list[Component], list[Reference]]:
    """The conditions of a series (4.0), one for each degree of freedom, and the histories they refer to."""
    out, references = [], []
    for dof, coefficient in _components(given):
        if form == "math":
            text = spelled_out(given.times, coefficient, given.origin)
        else:
            text, more = referring(dof, coefficient, given.origin)
            references += more
        value = Component("value", "math", text=text) if text != "0" else Component("value", text="0")
        still = Component("relative", text="0")
        parts = (value, still) if dof == "p" else (Component("dof", text=dof), value, still)
        kind = f"prescribed {'fluid pressure' if dof == 'p' else 'concentration' if dof[0] == 'c' else 'displacement'}"
        out.append(Component("bc", kind, f"handoff {dof}", None, "", {"node_set": node_set}, parts))
    return out, references


def helpers(references: list[Reference], times: Floats, material: int,
            controller: int) -> tuple[list[Component], list[LoadController]]:
    """Materials that no element uses, whose E follows a history, and the load curves of these."""
    materials: list[Component] = []
    curves: list[LoadController] = []
    for k, r in enumerate(references):
        if r.history is not None:
            curves.append(load_curve(controller + len(curves), r.name, times, r.history))
            e = Component("E", text="1", attrs={"lc": str(curves[-1].id)})
        else:
            e = Component("E", "math", text=r.text)
        materials.append(Component("material", "neo-Hookean", r.name, material + k, children=(
            Component("density", text="1"), e, Component("v", text="0.3"))))
    return materials, curves


# ---- files ---------------------------------------------------------------------------------------


def write(
    driven: Driven, path: str | PathLike[str], version: str = "4.0", overwrite: bool = True
) -> list[str]:
    """The driven model as a .feb file of a version; returns what was lost on the way to older ones.

    Raises InputError where the file exists and ``overwrite`` is False.
    """
    from febkit.feb import to_bytes

    data, lost = to_bytes(driven.model, version)
    if driven.form == "curves":
        parts = curve_sections(driven.handoff, driven.model.mesh.node_ids[driven.nodes],
                               _next_id(driven.model.controllers), version)
        data = insert(data, parts, version)
    put(path, data, overwrite)
    return lost


def write_section(
    driven: Driven, path: str | PathLike[str], version: str = "4.0", overwrite: bool = True
) -> None:
    """The hand-off alone as a .feb file, to be included after the cell model's own sections."""
    if driven.form == "curves":
        parts: Any = curve_sections(driven.handoff, driven.model.mesh.node_ids[driven.nodes],
                                    _next_id(driven.model.controllers), version)
    else:
        from febkit.feb.component import tag_of
        from febkit.feb.serialize import tag_text

        conditions, references = conditions_of(driven.handoff, driven.node_set, driven.form)
        own = [m for m in driven.model.materials if not (m.name or "").startswith("drive_")]
        mine = [c for c in driven.model.controllers if not (c.name or "").startswith("drive_")]
        first = max((m.id or k for k, m in enumerate(own, 1)), default=0) + 1
        materials, curves = helpers(references, driven.handoff.times, first, _next_id(mine))
        text = {"Material": materials, "Boundary": conditions, "LoadData": [c.spec for c in curves]}
        parts = {k: "".join(tag_text(tag_of(c), "\t\t") for c in v).encode() for k, v in text.items() if v}
    put(path, section_document(parts, driven.node_set, version), overwrite)

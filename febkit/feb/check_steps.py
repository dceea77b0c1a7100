"""Whether steps do anything: what holds and what drives a model, and how many steps are asked for."""

from __future__ import annotations

import re
from collections.abc import Iterator

from febkit.model import Component, InputError, Model, Step, Where

from .findings import Finding

MANY = 10_000_000  # steps; at a millisecond each they take three hours
DOFS = re.compile(r"[a-zA-Z]+_dof")
# materials that strain, pull or fill by themselves
ALIVE = re.compile(r"prestrain|growth|Donnan|osmo|activ|contract|generation|swelling|supply", re.IGNORECASE)
DRIVING = ("loads", "initial", "adaptors")  # sections of a step that move a model whatever they hold
HOLDING = ("contact", "constraints", "rigid")


def check(model: Model) -> Iterator[Finding]:
    for step in model.steps:
        if step.control is not None:
            yield from length(step.control)
    every = (model.common, *model.steps)
    for step in every:
        for c in step.boundary:
            flags = [x for x in c if DOFS.fullmatch(x.tag)]
            if c.type in ("zero displacement", "zero shell displacement") and not any(map(_on, flags)):
                message = f"{c.what} holds no degree of freedom: set <x_dof>1</x_dof> or the like"
                yield Finding("error", message, c.where)
    if model.steps and model.materials and model.module in ("solid", "biphasic"):
        yield from forces(model, every)


def _on(leaf: Component) -> bool:
    try:
        return leaf.as_bool()
    except InputError:
        return True


def length(control: Component) -> Iterator[Finding]:
    try:
        count, dt = control.int("time_steps", 10), control.float("step_size", 0.1)
        end = control.float("final_time", 0.0)
    except InputError:
        return  # said where the control is read
    if count == 0:
        message = "<time_steps> must be at least 1, or -1 for <final_time>, not 0"
        yield Finding("error", message, control.need("time_steps").where)
    steps = int(min(end / dt, 1e18)) if count == -1 and dt > 0 else count
    if steps > MANY:
        yield Finding("warning", f"{steps} time steps are asked for; at 1 ms each they take {steps / 8.64e7:.3g} days",
                      control.where)


def forces(model: Model, steps: tuple[Step, ...]) -> Iterator[Finding]:
    """A model that nothing drives or holds, which FEBio solves (\"No force acting on the system\")."""
    place = model.module_spec.where if model.module_spec is not None else Where(model.file)
    told = any(getattr(s, name) for s in steps for name in (*DRIVING, *HOLDING)) or bool(model.discrete)
    bcs = [c for s in steps for c in s.boundary]
    moved = any(c.type is None or not c.type.startswith("zero") for c in bcs)
    if not told and not moved and not any(map(_alive, model.materials)):
        yield Finding("warning", "nothing drives the model: it has no load and no prescribed or initial value", place)
    if not told and not bcs:
        yield Finding("warning", "nothing holds the model: it is free to move as a rigid body", place)


def _alive(c: Component) -> bool:
    return ALIVE.search(f"{c.tag} {c.type}") is not None or any(map(_alive, c.children))

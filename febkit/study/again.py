"""A second try of a solve that failed: the same model with smaller steps."""

from __future__ import annotations

from dataclasses import replace

from febkit.model import Component, LoadController, Model

SMALLER = 4  # times
SAID = "steps a quarter as long, down to a tenth of the shortest, twice as many retries"


def smaller_steps(model: Model) -> Model:
    """The model with steps (first, longest) a quarter as long to the same end, the shortest a tenth, more retries."""
    controllers = list(model.controllers)
    steps = tuple(
        s if s.control is None else replace(s, control=_control(s.control, controllers)) for s in model.steps
    )
    return replace(model, steps=steps, controllers=tuple(controllers), document=None)


def _control(c: Component, controllers: list[LoadController]) -> Component:
    size, number = c.float("step_size", 0.1), c.int("time_steps", 10)
    c = _with(_with(c, "step_size", repr(size / SMALLER)), "time_steps", str(number * SMALLER))
    stepper = c.child("time_stepper")
    if stepper is None:
        return c
    new = _with(stepper, "max_retries", str(2 * stepper.int("max_retries", 5)))
    shortest = stepper.float("dtmin", 0.0)
    new = _with(new, "dtmin", repr(shortest / 10)) if shortest else new
    longest = stepper.child("dtmax")
    if longest is not None and longest.lc is not None:
        new = _replaced(
            new, replace(longest, attrs={**longest.attrs, "lc": str(_shorter(longest.lc, controllers))})
        )
    else:
        new = _with(new, "dtmax", repr(stepper.float("dtmax", 0.1) / SMALLER))
    return _replaced(c, new)


def _shorter(number: int, controllers: list[LoadController]) -> int:
    """A load curve of values a quarter as large as another's, its number: others may follow that one, too."""
    old = next((k for k in controllers if k.id == number), None)
    if old is None or not old.points:
        return number
    rows = tuple((t, v / SMALLER) for t, v in old.points)
    points = Component("points", children=tuple(Component("pt", text=f"{t!r},{v!r}") for t, v in rows))
    new = max(k.id for k in controllers) + 1
    spec = replace(old.spec, id=new, children=(*(c for c in old.spec.children if c.tag != "points"), points))
    controllers.append(replace(old, id=new, spec=spec, points=rows))
    return new


def _with(c: Component, tag: str, text: str) -> Component:
    return _replaced(c, Component(tag, text=text))


def _replaced(c: Component, child: Component) -> Component:
    """A component with one child in the place of those of the same tag."""
    old = c.child(child.tag)
    kept = [x for x in c.children if x.tag != child.tag]
    at = len(kept) if old is None else min(c.children.index(old), len(kept))
    return replace(c, children=(*kept[:at], child, *kept[at:]))

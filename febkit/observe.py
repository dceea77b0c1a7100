"""Observables: what is followed of a result over time, said in words or by a function of its dataset.

- ``reaction top z``: force of the supports on a node set or surface, or the force on a rigid part;
- ``displacement set top z``: mean over a node set or surface; of forces their sum;
- ``displacement node 13 z``, ``stress element 7 zz``: at FEBio's node or element of that id;
- ``stress part plug zz``, ``pressure part plug``: mean over a part or element set, by deformed volumes of elements.

The variable is any plot variable by FEBio's name, or an element field of :data:`febkit.metrics.FIELDS`, which needs
displacements alone (``principal_strain part plug first``); ``pressure`` is short for ``effective fluid pressure``.
The last word is a component (z, zz, a solute), an invariant (first, effective, magnitude), or left out: vectors are
taken by magnitude, tensors by von Mises' formula. Names with spaces stand in quotes: ``reaction "top nodes" z``.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.model import InputError

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

    Follow = Callable[[xr.Dataset], Any]
    Observe = str | Follow | Sequence[str | Follow] | Mapping[str, str | Follow]

WHERE = {"part": "parts", "set": "sets", "surface": "sets", "node": "nodes", "element": "elements"}
SHORT = {"pressure": "effective fluid pressure"}
_SAY = 'say "reaction top z", "displacement node 13 z", "displacement set top z" or "stress part plug zz"'


@dataclass(frozen=True, slots=True)
class Observable:
    """A function of a dataset of results.

    name: the words or the function's name; variables: plot variables that a run must keep for it, None where it is not
    known which (a function's).
    """

    name: str
    follow: Follow
    variables: tuple[str, ...] | None = None

    def __call__(self, ds: xr.Dataset) -> xr.DataArray:
        """(time,) values with their units; of a function what it gives: an array over time, or a number.

        Raises InputError where the result does not hold it.
        """
        import xarray as xr

        v = self.follow(ds)
        if not isinstance(v, xr.DataArray):
            a = np.asarray(v, dtype=float)
            if a.ndim > 1 or (a.ndim and len(a) != ds.sizes["time"]):
                raise InputError(f"{self.name} gives {a.shape} values: give one, one for each state, or a DataArray")
            v = xr.DataArray(a, {"time": ds["time"]} if a.ndim else {}, ("time",) if a.ndim else ())
        units = {k: v.attrs[k] for k in ("units",) if k in v.attrs}
        return v.rename(self.name).assign_attrs({"long_name": self.name} | units)


def observables(given: Observe) -> dict[str, Observable]:
    """Observables by name; of a mapping the names are its keys. Raises InputError for words that say none."""
    if isinstance(given, Mapping):
        return {name: observable(v) for name, v in given.items()}
    each = [given] if isinstance(given, str) or callable(given) else list(given)
    made = [observable(v) for v in each]
    if len({o.name for o in made}) < len(made):
        raise InputError("two observables have one name: give a mapping of names")
    return {o.name: o for o in made}


def observable(given: str | Follow | Observable) -> Observable:
    """What words or a function say. Raises InputError for words that say nothing."""
    if isinstance(given, Observable):
        return given
    if callable(given):
        return Observable(getattr(given, "__name__", type(given).__name__), given)
    try:
        words = shlex.split(given)
    except ValueError as e:
        raise InputError(f"observable {given!r}: {e}; {_SAY}") from None
    name = " ".join(given.split())
    if words[:1] == ["reaction"] and len(words) in (2, 3):
        follow = _reaction(words[1], words[2] if len(words) == 3 else "")
        return Observable(name, follow, ("reaction forces",))
    at = next((k for k, w in enumerate(words) if k and w in WHERE), len(words))
    if not 2 <= len(words[at:]) <= 4:
        raise InputError(f"observable {given!r}: {_SAY}")
    head = " ".join(words[:at])
    variable, where, what = SHORT.get(head, head), words[at], words[at + 1]
    if where in ("node", "element") and not what.isdigit():
        raise InputError(f"observable {given!r}: {where} {what!r} is no id; {_SAY}")
    place: Any = int(what) if where in ("node", "element") else what
    follow = _value(":".join([variable, *words[at + 2 :]]), WHERE[where], place)
    return Observable(name, follow, _needed(variable, where))


def variables(chosen: Mapping[str, Observable], model: Model) -> list[str] | None:
    """Plot variables that a run of the model must keep for all of them; None where a function may ask for any."""
    out = {"rigid force": None} if any(m.type == "rigid body" for m in model.materials) else {}
    for o in chosen.values():
        if o.variables is None:
            return None
        out |= dict.fromkeys(o.variables)
    return list(out)


def check(chosen: Mapping[str, Observable], model: Model, kept: Sequence[str] | None) -> None:
    """Raise InputError for words that no result of the model, of the plot variables ``kept``, can answer.

    They are asked of a state without values. Functions are not: what they do depends on these.
    """
    from dataclasses import replace

    from febkit.files import Buffer
    from febkit.model import PlotVariable
    from febkit.output.plotfile import PlotListener
    from febkit.results import held

    if kept is not None:
        model = replace(model, output=replace(model.output, plot=tuple(map(PlotVariable, kept))))
    buffer, said = Buffer(), list[str]()
    PlotListener(model, buffer, said.append).writer.state(0.0, {})
    ds = held(buffer.data)
    for o in chosen.values():
        if o.variables is not None:
            try:
                o(ds)
            except InputError as e:
                raise InputError("; ".join([f"observable {o.name!r}: {e.message}", *said])) from None


def _reaction(name: str, word: str) -> Follow:
    from febkit.metrics.summary import scalar_of

    def follow(ds: xr.Dataset) -> xr.DataArray:
        v: xr.DataArray = ds.febkit.reaction(name)
        values = scalar_of("reaction", word or "magnitude", v, np.asarray(v.values, dtype=float))
        return v.isel(xyz=0, drop=True).copy(data=values)

    return follow


def _value(text: str, where: str, name: Any) -> Follow:
    def follow(ds: xr.Dataset) -> xr.DataArray:
        import xarray as xr

        from febkit.plots.curve import curve, places
        from febkit.plots.quantity import quantity

        q = quantity(ds, text)
        (place,) = places(ds, **{kind: [name] if kind == where else () for kind in WHERE.values()})
        attrs = {"units": q.units} if q.units else {}
        return xr.DataArray(curve(q, place), {"time": ds["time"]}, ("time",), attrs=attrs)

    return follow


def _needed(variable: str, where: str) -> tuple[str, ...]:
    """Plot variables that its value takes. Raises InputError for a variable that nobody knows."""
    from febkit.feb.features import table
    from febkit.metrics import FIELDS

    spaced, field = variable.replace("_", " "), variable.replace(" ", "_")
    known = table()["plot"]
    for name in (variable, spaced):
        if name in known:
            return tuple(dict.fromkeys((name, "displacement") if where == "part" else (name,)))
    if field in FIELDS:
        return ("displacement", "stress") if FIELDS[field][0] == "stress" else ("displacement",)
    from difflib import get_close_matches

    close = get_close_matches(variable, [*known, *FIELDS], 1)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    raise InputError(f"no plot variable or element field is called {variable!r}{hint}")

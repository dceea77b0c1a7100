"""Derivatives of results by parameters of a model: ``model.solve(sensitivity=[...])``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError
from febkit.model import Model as Record

from .text import is_number

if TYPE_CHECKING:
    import xarray as xr

    from febkit.observe import Observe
    from febkit.solver.problem import Problem
    from febkit.solver.run import Listener

    from .model import Model

Given = Sequence[str] | Mapping[str, float]
FAR = 1e-3  # of a parameter, for differences of whole runs
ONE_SIDED = 1e-4  # tolerance from which differences in one direction are good enough
OPTIONS = ("threads", "linear", "factor", "stabilise")  # of a run that matter to another one
NEAR = 1e-4  # of a parameter, for differences of observables


@dataclass(frozen=True)
class Parameter:
    """path: where it stands; value: the number there, 1 for a factor of a formula or map; size: what is much of it."""

    path: str
    value: float
    size: float
    formula: str = ""

    @classmethod
    def of(cls, model: Model, path: str, size: float | None) -> Parameter:
        """Raises InputError where the path leads to nothing, or to what is no number, formula or map."""
        found = model[path]
        if is_number(found):
            return cls(path, float(found), size or abs(float(found)) or 1.0)
        if isinstance(found, str) and found:
            return cls(path, 1.0, size or 1.0, found)
        raise InputError(f"sensitivity: {path} is {found!r}, which is no number")

    def moved(self, model: Model, amount: float) -> tuple[Record, float]:
        """The model with ``amount`` more, and how much more that is as the file holds it."""
        m, new = model.copy(), self.value + amount
        m[self.path] = f"({self.formula})*{new!r}" if self.formula else new
        return m.record, new - self.value


def parameters(model: Model, given: Given) -> list[Parameter]:
    """The parameters of paths, of a mapping with the sizes in which they are thought of."""
    sizes: Mapping[str, Any] = given if isinstance(given, Mapping) else dict.fromkeys(given)
    if isinstance(given, str) or not sizes:
        raise InputError("sensitivity= takes a list of parameter paths")
    return [Parameter.of(model, path, size) for path, size in sizes.items()]


class Sensitivity:
    """What a run is asked for its derivatives by: ``listeners`` go with it, :meth:`dataset` comes of them."""

    def __init__(self, model: Model, given: Given, tolerance: float, options: Mapping[str, Any]) -> None:
        from febkit.lower import lower
        from febkit.output.derivatives import Derivatives
        from febkit.solver.sensitivity import BOTH, STEP, Sensitivities, refusal

        self.model, self.options = model, options
        self.parameters = parameters(model, given)
        why = refusal(lower(model.record))
        if options.get("accuracy"):
            why = "steps of second order are not differentiated; runs beside take the same ones by backward Euler"
        self._why = why
        sides = (STEP,) if tolerance >= ONE_SIDED else (BOTH, -BOTH)
        varied = [] if why else [[self._beside(p, h * p.size) for h in sides] for p in self.parameters]
        self.run = Sensitivities(varied, tolerance)
        self.plots = Derivatives(model.record, self.run)
        self.listeners: list[Listener] = [self.run, self.plots]

    def _beside(self, p: Parameter, amount: float) -> tuple[Problem, float]:
        """The problem with a parameter moved, to the other side where its range ends."""
        from febkit.lower import lower

        try:
            moved, delta = p.moved(self.model, amount)
        except InputError:
            moved, delta = p.moved(self.model, -amount)
        return lower(moved), delta

    def dataset(self, base: xr.Dataset) -> xr.Dataset:
        """Derivatives of the variables of ``base`` (parameter, ...)."""
        import xarray as xr

        from febkit.results import held

        why = [self._why or self.run.lost(k) for k in range(len(self.parameters))]
        direct = self._direct(base["time"].values)
        others: dict[int, xr.Dataset | None] = {}
        for k in (k for k, w in enumerate(why) if w):
            data, stopped = self._difference(self.parameters[k])
            why[k] += f"; the runs beside stopped: {stopped}" * bool(stopped)
            others[k] = held(data).load().reindex(time=base["time"]) if data else None
        names = [n for n, v in base.data_vars.items() if "time" in v.dims and v.dtype.kind == "f"]
        fields = {}
        for n in names:
            v = base[n]
            rows = direct[n] if n in direct else np.full((len(why), *v.shape), np.nan)
            for k, part in others.items():
                rows[k] = np.nan if part is None else part[n].values
            fields[n] = (("parameter", *v.dims), rows, {"long_name": f"derivative of {n} by the parameter"})
        coords = {
            "parameter": [p.path for p in self.parameters],
            "method": ("parameter", ["differences" if w else "direct" for w in why]),
            "value": ("parameter", [p.value for p in self.parameters]),
            "size": ("parameter", [p.size for p in self.parameters]),
        }
        out = xr.Dataset(fields, {**base.coords, **coords}, base.attrs)
        return out.assign_attrs(why={p.path: w for p, w in zip(self.parameters, why) if w})

    def _direct(self, times: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Derivatives (parameter, time, ...) that the run has brought, nan at times that it did not come to."""
        from febkit.results import held

        if not self.plots.buffer.data:
            return {}
        every, many = held(self.plots.buffer.data).load(), len(self.parameters)
        row = {t: k for k, t in enumerate(every["time"].values[::many].tolist())}
        have = [k for k, t in enumerate(times.tolist()) if t in row]
        at, out = [row[times[k]] for k in have], {}
        for n, v in every.data_vars.items():
            if v.dims[:1] == ("time",) and v.dtype.kind == "f":
                out[str(n)] = np.full((many, len(times), *v.shape[1:]), np.nan)
                out[str(n)][:, have] = np.swapaxes(v.values.reshape(-1, many, *v.shape[1:])[at], 0, 1)
        return out

    def _difference(self, p: Parameter) -> tuple[bytes | bytearray, str]:
        """Central differences of whole runs, in the run's own steps and to tight tolerances; why they ended early."""
        from febkit.lower import lower
        from febkit.output.derivatives import Difference, Kept
        from febkit.solver.options import Options
        from febkit.solver.retrace import Retraced

        options = Options(**{k: v for k, v in self.options.items() if k in OPTIONS})
        high, more = p.moved(self.model, FAR * p.size)
        low, less = p.moved(self.model, -FAR * p.size)
        kept = Kept(self.model.record)
        first = Retraced(lower(low), [kept], options, self.run.steps).solve()
        out = Difference(self.model.record, kept.kept, more - less)
        second = Retraced(lower(high), [out], options, self.run.steps).solve()
        return out.buffer.data, first.reason or second.reason


def of_observables(observe: Observe, base: xr.Dataset, derivatives: xr.Dataset) -> xr.Dataset:
    """Derivatives of observables (parameter, time), by differences of them along the fields' derivatives."""
    import xarray as xr

    from febkit.observe import observables

    exact = {n: (base[n].dims, base[n].values.astype(np.float64), base[n].attrs) for n in derivatives.data_vars}
    out: dict[str, list[xr.DataArray]] = {}
    chosen = observables(observe)
    for k in range(derivatives.sizes["parameter"]):
        h = NEAR * float(derivatives["size"][k])
        slopes = {n: h * derivatives[n].values[k] for n in exact}
        ends = [base.assign({n: (d, v + s * slopes[n], a) for n, (d, v, a) in exact.items()}) for s in (1.0, -1.0)]
        for name, o in chosen.items():
            out.setdefault(name, []).append((o(ends[0]) - o(ends[1])) / (2.0 * h))
    joined = {n: xr.concat(v, derivatives["parameter"]) for n, v in out.items()}
    return xr.Dataset(joined)

"""What is drawn: a scalar of a result, by the name that a user gives it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.metrics.fields import COMPONENTS, FIELDS, element_fields
from febkit.metrics.summary import TENSOR, scalar_of
from febkit.model import InputError

from . import canvas

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
PLACES = {"node": "node", "element": "element", "facet": "facet", "domain": "domain", "surface": "surface"}
_DEFAULT = {"voigt": "effective", "xyz": "magnitude", "principal": "1"}
_ALIASES = {"von_mises": "effective", "von mises": "effective", "norm": "magnitude", "max_shear": "max_difference",
            "pressure": "mean"}  # fmt: skip
_SAID = {"effective": "effective", "first": "1st principal value", "second": "2nd principal value",
         "third": "3rd principal value", "max_difference": "greatest difference of principal values",
         "mean": "mean normal value",
         "1": "1st", "2": "2nd", "3": "3rd", "magnitude": "magnitude"}  # fmt: skip
_ORDER = ("first", "second", "third")


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """A scalar on nodes, elements, facets, domains (parts), surfaces, or the whole model (``place`` "").

    variable  its array, one component left to pick by ``word``; None for an element field of the metrics
    """

    ds: xr.Dataset
    name: str
    word: str
    place: str
    units: str
    variable: xr.DataArray | None = None
    model: Model | None = None

    @property
    def text(self) -> str:
        """ "stress, von Mises", "displacement, z"."""
        word = _SAID.get(self.word, self.word)
        if self.word == "effective" and "stress" in self.name:
            word = "von Mises"
        return self.name.replace("_", " ") + (f", {word}" if word else "")

    @property
    def label(self) -> str:
        return canvas.labelled(self.text, self.units)

    def state(self, t: int, rows: Ints | None = None) -> Floats:
        """(n,) values at a state, at these rows of its place or at all."""
        return np.asarray(self.history(rows, [t])[0])

    def history(self, rows: Ints | None = None, times: Any = None) -> Floats:
        """(time, n) values at these rows of its place, at these states or at all; (time, 1) of the whole model."""
        v = self.variable
        if v is None:
            return self._field(rows, times)
        if times is not None and "time" in v.dims:
            v = v.isel(time=times)
        if rows is not None and self.place:
            v = v.isel({self.place: rows})
        n = self.ds.sizes["time"] if times is None else len(times)
        if "time" not in v.dims:
            v = v.expand_dims(time=n)
        return np.stack([self._one(v.isel(time=k)) for k in range(n)]) if n else np.empty((0, 0))

    def _one(self, v: xr.DataArray) -> Floats:
        """(n,) of a state."""
        from febkit.results.mesh import local_mean

        a = np.asarray(v.values, dtype=float)
        for local in ("local", "facet_local"):
            if local in v.dims:
                a = local_mean(a, v.dims.index(local))
                v = v.isel({local: 0})
        if not self.place:
            a, v = a[None], v.expand_dims("model")
        return np.asarray(scalar_of(self.name, self.word, v, a))

    def _field(self, rows: Ints | None, times: Any) -> Floats:
        ds = self.ds if times is None else self.ds.isel(time=times)
        wanted = np.arange(ds.sizes["element"]) if rows is None else np.asarray(rows)
        f = element_fields(ds, {"shown": np.unique(wanted)}, self.model, [self.name])
        if self.name not in f:
            raise InputError(f"{self.name} cannot be had from this result without its model")
        v = f[self.name].isel(element=np.searchsorted(f["element_row"].values, wanted))
        return np.stack([_of_field(self.name, self.word, v.isel(time=k)) for k in range(v.sizes["time"])])


def quantity(ds: xr.Dataset, text: str, model: Model | None = None) -> Quantity:
    """The scalar that ``text`` names.

    "effective fluid pressure", "displacement:z", "stress:zz", "stress:first" (largest principal value),
    "concentration:Na", or an element field of :data:`febkit.metrics.FIELDS` ("effective_strain",
    "principal_strain:first"; ``model`` as there). Vectors without a word are taken by magnitude, symmetric tensors by
    the von Mises formula. Raises InputError that lists what there is.
    """
    from febkit.results.dataset import variable_name

    head, _, word = text.partition(":")
    name, word = variable_name(head), _ALIASES.get(word.strip().lower(), word.strip())
    if name in ds.data_vars:
        v, word = _picked(ds[name], name, word)
        place = next((d for d in v.dims if d in PLACES), "")
        strange = set(v.dims) - {"time", place, "local", "facet_local"} - set(v.dims[-1:])
        if (not place and any(str(d).endswith(("_node", "_line", "_byte")) for d in v.dims)) or strange:
            raise InputError(f"{name} lives on {', '.join(map(str, v.dims))}: that cannot be drawn")
        return Quantity(ds, name, word, str(place), str(ds[name].attrs.get("units", "")), v, model)
    if name in FIELDS:
        return Quantity(ds, name, _field_word(name, word), "element", _field_units(ds, name, model), None, model)
    raise InputError(f"the result has no {name!r}; it has {', '.join(map(str, ds.data_vars))}, "
                     f"and the fields {', '.join(FIELDS)}")  # fmt: skip


def _picked(v: xr.DataArray, name: str, word: str) -> tuple[xr.DataArray, str]:
    """The array with one component axis at most, and the word of that axis: species are picked here."""
    axes = [d for d in v.dims if d not in ("time", "local", "facet_local", *PLACES)]
    if len(axes) == 2:
        first, _, word = word.partition(":")
        labels = _labels(v, axes[0])
        if first not in labels:
            raise InputError(f'say which {axes[0]} of {name}: "{name}:{labels[0]}:z"; there are {", ".join(labels)}')
        v, axes = v.isel({axes[0]: labels.index(first)}), axes[1:]
    if not axes:
        if word:
            raise InputError(f"{name} is a scalar: leave {word!r} out")
        return v, ""
    axis = str(axes[0])
    if not word:
        labels = _labels(v, axis)
        word = _DEFAULT.get(axis) or (labels[0] if len(labels) == 1 else "")
    if axis not in v.coords:
        v = v.assign_coords({axis: [str(k + 1) for k in range(v.sizes[axis])]})
    choices = words(v)
    if word not in choices:
        raise InputError(f'say which component of {name}: "{name}:{choices[0]}", or one of {", ".join(choices[1:])}')
    return v, word


def _labels(v: xr.DataArray, axis: Any) -> list[str]:
    return [str(c) for c in v[axis].values] if axis in v.coords else [str(k + 1) for k in range(v.sizes[axis])]


def words(v: xr.DataArray) -> list[str]:
    """What may follow the colon after a variable's name: components first, then invariants; [] of a scalar."""
    axes = [d for d in v.dims if d not in ("time", "local", "facet_local", *PLACES)]
    if not axes:
        return []
    if len(axes) == 2:
        return [f"{a}:{b}" for a in _labels(v, axes[0]) for b in (*_labels(v, axes[1]), "magnitude")]
    more = list(TENSOR) if axes[0] == "voigt" else ["magnitude"] if axes[0] == "xyz" else []
    return [*_labels(v, axes[0]), *more]


def _field_word(name: str, word: str) -> str:
    choices = ("magnitude", *"xyz") if name == "fluid_flux" else _ORDER if name in COMPONENTS else ()
    word = dict(zip("123", _ORDER)).get(word, word) if choices == _ORDER else word
    if not choices and word:
        raise InputError(f"{name} is a scalar: leave {word!r} out")
    if choices and word and word not in choices:
        raise InputError(f'say which component of {name}: "{name}:{choices[0]}", or one of {", ".join(choices[1:])}')
    return word or (choices[0] if choices else "")


def _of_field(name: str, word: str, v: xr.DataArray) -> Floats:
    a = np.asarray(v.values, dtype=float)
    if a.ndim == 1:
        return a
    if word == "magnitude":
        return np.asarray(np.linalg.norm(a, axis=-1))
    return np.asarray(a[:, (_ORDER if word in _ORDER else tuple("xyz")).index(word)])


def _field_units(ds: xr.Dataset, name: str, model: Model | None) -> str:
    from febkit.metrics.scale import Scale, unit_system

    return str(Scale(unit_system(ds, model)).attrs(FIELDS[name][0]).get("units", ""))


def time_index(ds: xr.Dataset, time: float | None) -> int:
    """The state at a time, the last where none is named. Raises InputError where there is none."""
    from febkit.results.subsets import state_at

    return state_at(ds["time"].values, time, 1e-3, 1e-3)


def clock(ds: xr.Dataset, at: int) -> str:
    """ "t = 0.5 s"."""
    unit = canvas.pretty(str(ds["time"].attrs.get("units", "")))
    return f"t = {float(ds['time'].values[at]):.4g} {unit}".rstrip()

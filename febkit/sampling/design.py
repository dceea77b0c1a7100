"""At which values a model is solved: points of a box of parameters."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

if TYPE_CHECKING:
    from febkit.modelling import Model

Floats = NDArray[np.float64]
DESIGNS = {
    "sobol": "Sobol's sequence, scrambled: even in all directions, best with 2^m samples",
    "lhs": "a Latin hypercube: each parameter's range is cut into as many intervals as there are samples",
    "random": "independent and uniform",
    "grid": "the largest full grid of at most as many samples, ends included",
    "saltelli": "samples (parameters + 2) runs, from which Sobol indices can be had (needs febkit[sensitivity])",
}


@dataclass(frozen=True, slots=True)
class Range:
    """A parameter by its path, from ``low`` to ``high``."""

    path: str
    low: float
    high: float


def ranges(vary: Mapping[str, Sequence[float]], model: Model) -> tuple[Range, ...]:
    """The ranges of a mapping from paths to (low, high). Raises InputError where the model cannot have their ends."""
    out = []
    for path, ends in vary.items():
        try:
            low, high = map(float, ends)
        except (TypeError, ValueError):
            raise InputError(f"{path}: (low, high) is wanted, not {ends!r}") from None
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise InputError(f"{path}: low < high is wanted, not {low:g} and {high:g}")
        out.append(Range(path, low, high))
    if not out:
        raise InputError('a sweep varies something: {"cartilage.solid.E": (0.1, 2.0)}')
    for end in ("low", "high"):
        trial = model.copy()
        for r in out:
            try:
                trial[r.path] = getattr(r, end)
            except AttributeError as e:
                raise InputError(f"{r.path}: {e}") from None
    return tuple(out)


def told(text: str) -> tuple[str, tuple[float, float]]:
    """``path=low:high``."""
    path, equals, ends = text.rpartition("=")
    try:
        low, high = map(float, ends.split(":"))
    except ValueError:
        equals = ""
    if not equals or not path.strip():
        raise InputError(f"--vary {text}: it takes PATH=LOW:HIGH, as in --vary cartilage.solid.E=0.1:2")
    return path.strip(), (low, high)


def points(over: Sequence[Range], samples: int, design: str, seed: int) -> Floats:
    """(sample, parameter) values of a design (:data:`DESIGNS`); the same for the same seed."""
    if design not in DESIGNS:
        raise InputError(f"design {design!r} is none of {', '.join(DESIGNS)}")
    if samples < 1 or seed < 0:
        raise InputError("a sweep takes one sample or more, and a seed from 0 on")
    unit = _unit(len(over), samples, design, seed)
    low, high = (np.array([getattr(r, end) for r in over]) for end in ("low", "high"))
    return np.asarray(low + unit * (high - low))


def _unit(k: int, samples: int, design: str, seed: int) -> Floats:
    """Points (sample, k) of the unit cube."""
    if design == "grid":
        n = int(samples ** (1 / k) + 1e-9)
        if n < 2:
            raise InputError(f"a grid of {k} parameters takes {2**k} samples or more, not {samples}")
        return np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, n)] * k, indexing="ij"), axis=-1).reshape(-1, k)
    rng = np.random.default_rng(seed)
    if design == "random":
        return rng.random((samples, k))
    if design == "saltelli":
        from .sensitivity import saltelli

        return saltelli(k, samples, seed)
    from scipy.stats import qmc

    made = qmc.Sobol(k, seed=rng) if design == "sobol" else qmc.LatinHypercube(k, seed=rng)
    with warnings.catch_warnings():  # of numbers that are no power of two
        warnings.simplefilter("ignore", UserWarning)
        return np.asarray(made.random(samples))

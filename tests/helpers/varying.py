"""Laws with other numbers: one for each point, or some more."""

from __future__ import annotations

from dataclasses import fields, is_dataclass

import numpy as np

from febkit.solver.values import Constant, Map, as_value

#: permeabilities and what their numbers are
PERMEABILITIES = {
    "perm-const-iso": {"perm": 0.7},
    "perm-Holmes-Mow": {"perm": 0.7, "M": 1.3, "alpha": 2.1},
    "perm-exp-iso": {"perm": 0.7, "M": 1.3},
    "perm-ref-iso": {"perm0": 0.7, "perm1": 0.4, "perm2": 0.3, "M": 1.3, "alpha": 2.1},
    "perm-ref-trans-iso": {
        "perm0": 0.7, "perm1T": 0.4, "perm1A": 0.6, "perm2T": 0.3, "perm2A": 0.5, "M0": 1.3, "MT": 0.8, "MA": 0.4,
        "alpha0": 2.1, "alphaT": 1.7, "alphaA": 1.2,
    },
    "perm-ref-ortho": {
        "perm0": 0.7, "M0": 1.3, "alpha0": 2.1, "perm1": (0.4, 0.5, 0.6), "perm2": (0.3, 0.2, 0.1),
        "M": (0.8, 0.4, 0.2), "alpha": (1.7, 1.2, 0.5),
    },
}  # fmt: skip


def varied(record, n, only=None, seed=7):
    """Turn each number of ``record`` and below into one for each of ``n`` points, a few per cent apart.

    Returns the names of those that are not zero; ``only`` turns the one of this name alone.
    """
    rng, names = np.random.default_rng(seed), []

    def turned(name, v):
        if name.endswith("tangent_scale"):  # which breaks the law of tangents
            return v
        data = v.number * (1.0 + 0.04 * rng.uniform(-1, 1, n))
        if v.number:
            names.append(name)
        return Map(data) if only in (None, name) else v

    _turn(record, turned)
    return names


def moved(record, amounts):
    """Add to the numbers of ``record`` and below what ``amounts`` has for their names; the numbers, by name."""
    numbers = {}

    def turned(name, v):
        numbers[name] = v.number
        return Constant(v.number + amounts.get(name, 0.0))

    _turn(record, turned)
    return numbers


def _turn(record, turned, prefix=""):
    """Put ``turned`` (name, number) in the place of each number of a record and below."""

    def of(name, v):
        v = as_value(v) if name.endswith("density_") else v
        if isinstance(v, Constant):
            return turned(name, v)
        if isinstance(v, (tuple, list)):
            return type(v)(of(f"{name}[{k}]", x) for k, x in enumerate(v))
        if is_dataclass(v) and not isinstance(v, (type, Map)):
            _turn(v, turned, f"{name}.")
        return v

    for f in fields(record):
        setattr(record, f.name, of(prefix + f.name, getattr(record, f.name)))
    _made_again(record)


def _made_again(record):
    """Have a record that makes others of its numbers make them of the present ones."""
    if hasattr(record, "__post_init__"):
        record.__post_init__()


def alone(record, k):
    """A varied record as the point ``k`` has it: numbers again."""

    def turned(v):
        if isinstance(v, Map):
            return Constant(float(v.data[k]))
        if isinstance(v, (tuple, list)):
            return type(v)(turned(x) for x in v)
        if is_dataclass(v) and not isinstance(v, (type, Constant)):
            for f in fields(v):
                setattr(v, f.name, turned(getattr(v, f.name)))
            _made_again(v)
        return v

    return turned(record)

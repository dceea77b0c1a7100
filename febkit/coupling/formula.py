"""A series as FEBio expressions: histories c_k(t) times fixed polynomials of X, Y, Z.

FEBio 4.11 reads an expression into 512 characters and crashes on a longer one. Two ways to stay within:

- "math": c_k(t) spelled out, a + sum_i c_i |t - t_i|, where that is short enough (few times, low order);
- "parameters": each c_k(t) is a load curve on a parameter of a material that no element uses, and the
  expression refers to it, ``X*Y*${fem.material('drive_xXY').E}``. Any number of times; tried in FEBio 4.11.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import NDArray

from .derivatives import TERMS

Floats = NDArray[np.float64]

LONGEST = 500  # characters of an expression; FEBio 4.11 has room for 511
PREFIX = "drive_"


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """A helper material: its name, and the history its E follows, or the expression its E is."""

    name: str
    history: Floats | None = None  # (t,)
    text: str = ""

    @property
    def spelled(self) -> str:
        return "${fem.material('" + self.name + "').E}"


def monomial(axes: Sequence[int], origin: Floats) -> str:
    """X*Y, X^2, (Z-0.1), ... of a term; "" for the constant one."""
    out = []
    for a, letter in enumerate("XYZ"):
        n = list(axes).count(a)
        if n:
            o = float(origin[a])
            base = letter if o == 0 else f"({letter}{'-' if o > 0 else '+'}{abs(o)!r})"
            out.append(base if n == 1 else f"{base}^{n}")
    return "*".join(out)


def history(times: Floats, values: Floats) -> str:
    """A piecewise linear history, constant outside its times: a + sum_i c_i |t - t_i|.

    c_i is half the change of slope at t_i and a = (first + last value) / 2.
    """
    if np.ptp(values) == 0.0:
        return _signed(float(values[0]))
    slopes = np.concatenate([[0.0], np.diff(values) / np.diff(times), [0.0]])
    c = np.diff(slopes) / 2
    out = _signed(float(values[0] + values[-1]) / 2)
    for t, k in zip(times.tolist(), c.tolist()):
        if k != 0.0:
            out += f"{_signed(k)}*abs(t-{t!r})" if t >= 0 else f"{_signed(k)}*abs(t+{-t!r})"
    return out


def _signed(v: float) -> str:
    return f"{'-' if v < 0 else '+'}{abs(v)!r}"


def terms_of(coefficient: Floats) -> list[tuple[int, Floats]]:
    """(term, history) of the coefficients (t, terms) that are not always zero, factorials divided out."""
    out = []
    for k in range(coefficient.shape[1]):
        if np.any(coefficient[:, k]):
            scale = np.prod([factorial(TERMS[k].count(a)) for a in range(3)])
            out.append((k, coefficient[:, k] / scale))
    return out


def spelled_out(times: Floats, coefficient: Floats, origin: Floats) -> str:
    """The whole series (t, terms) of one component as one expression of X, Y, Z and t."""
    out = ""
    for k, values in terms_of(coefficient):
        m = monomial(TERMS[k], origin)
        text = history(times, values).lstrip("+")
        out += f"+{m}*({text})" if m else f"+({text})"
    return out.lstrip("+") or "0"


def referring(label: str, coefficient: Floats, origin: Floats) -> tuple[str, list[Reference]]:
    """An expression of one component ("x", "y", "z", "p") that refers to histories, and what it refers to."""
    references, pieces = [], []
    for k, values in terms_of(coefficient):
        m = monomial(TERMS[k], origin)
        r = Reference(f"{PREFIX}{label}{''.join('XYZ'[a] for a in TERMS[k]) or '0'}", values)
        references.append(r)
        pieces.append(f"{m}*{r.spelled}" if m else r.spelled)
    if not pieces:
        return "0", []
    chunks, helpers = _chunks(pieces), []
    for n, chunk in enumerate(chunks[1:], 2):
        helpers.append(Reference(f"{PREFIX}{label}_{n}", text=chunk))
    return "+".join([chunks[0], *(h.spelled for h in helpers)]), references + helpers


def _chunks(pieces: list[str]) -> list[str]:
    """Pieces joined by + into texts within :data:`LONGEST`, the first with room to refer to the others."""
    out, room = [""], LONGEST - 80
    for p in pieces:
        if out[-1] and len(out[-1]) + 1 + len(p) > room:
            out.append(p)
            room = LONGEST
        else:
            out[-1] += ("+" if out[-1] else "") + p
    return out

"""Quasi-Newton updates of a factored tangent.

BFGS: Matthies and Strang, Int J Numer Meth Engng 14 (1979), in product form as FEBio uses it (theory
manual, "The BFGS method"). Broyden: Engelman, Strang and Bathe, Int J Numer Meth Engng 17 (1981).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .kernels.vectors import add_along
from .linear.krylov import Ints, weights
from .problem import NewtonOptions
from .vectors import dot

Floats = NDArray[np.float64]
Back = Callable[[Floats], Floats]  # solve with the factored tangent


class Update(Protocol):
    count: int

    def reset(self) -> None: ...

    def begin(self) -> None: ...

    def solve(self, b: Floats) -> Floats: ...

    def update(self, s: float, u: Floats, R0: Floats, R1: Floats) -> bool: ...


class FullNewton:
    """No updates: the tangent is renewed in every iteration."""

    def __init__(self, back: Back, options: NewtonOptions) -> None:
        self.back, self.count = back, 0

    def reset(self) -> None:
        self.count = 0

    def begin(self) -> None:
        pass

    def solve(self, b: Floats) -> Floats:
        return self.back(b)

    def update(self, s: float, u: Floats, R0: Floats, R1: Floats) -> bool:
        return False


class ModifiedNewton(FullNewton):
    """No updates: the tangent of the step's start serves until it leads astray."""

    def update(self, s: float, u: Floats, R0: Floats, R1: Floats) -> bool:
        self.count += 1
        return True


class _Buffered:
    def __init__(self, back: Back, options: NewtonOptions) -> None:
        self.back, self.most, self.cycle, self.cmax = back, options.updates, options.cycle, options.cmax
        self.size = options.buffer or options.updates
        self.count = 0
        self._a: list[Floats] = []
        self._b: list[Floats] = []

    def reset(self) -> None:
        self.count = 0
        self._a.clear()
        self._b.clear()

    def begin(self) -> None:
        pass

    def _keep(self, a: Floats, b: Floats) -> None:
        if len(self._a) < self.size:
            self._a.append(a)
            self._b.append(b)
        elif self.cycle:
            self._a[:] = [*self._a[1:], a]
            self._b[:] = [*self._b[1:], b]


class BFGS(_Buffered):
    """K^-1 = prod (I + w v^T) K0^-1 prod (I + v w^T)."""

    def solve(self, b: Floats) -> Floats:
        t = b.copy()
        for v, w in zip(reversed(self._a), reversed(self._b)):
            add_along(v, w, t)
        x = self.back(t)
        for v, w in zip(self._a, self._b):
            add_along(w, v, x)
        return x

    def update(self, s: float, u: Floats, R0: Floats, R1: Floats) -> bool:
        if self.count >= self.most - 1:
            return False
        d, g, h = s * u, R0 - R1, s * R0
        dg, dh = dot(d, g), dot(d, h)
        if dg == 0.0 or dh == 0.0:
            return False
        c = np.sqrt(abs(dg / dh))
        if not c <= self.cmax:
            return False
        self._keep(-c * h - g, d / dg)
        self.count += 1
        return True


class Broyden(_Buffered):
    """Rank-one updates of the inverse, one solve with the factored tangent per iteration."""

    def __init__(self, back: Back, options: NewtonOptions) -> None:
        super().__init__(back, options)
        self._rho: list[float] = []
        self._q: Floats | None = None
        self._fresh = True

    def reset(self) -> None:
        super().reset()
        self._rho.clear()

    def begin(self) -> None:
        self._fresh = True

    def _apply(self, q: Floats, k: int) -> Floats:
        for r, d, rho in zip(self._a[:k], self._b[:k], self._rho[:k]):
            q += rho * dot(d, q) * (d - r)
        return q

    def solve(self, b: Floats) -> Floats:
        if self.count == 0:
            self._fresh = False
            return self.back(b)
        k = len(self._a) - 1
        if self._fresh or self._q is None:
            self._q = self._apply(self.back(b), k)
            self._fresh = False
        r, d, rho = self._a[k], self._b[k], self._rho[k]
        return self._q + rho * dot(d, self._q) * (d - r)

    def update(self, s: float, u: Floats, R0: Floats, R1: Floats) -> bool:
        if self.count >= self.most - 1:
            return False
        k = len(self._a) if len(self._a) < self.size else self.size - 1
        if len(self._a) == self.size and self.cycle:
            self._rho.pop(0)
            keep = slice(1, None)
            self._a[:], self._b[:] = self._a[keep], self._b[keep]
        q = self._apply(self.back(R1), k)
        self._q = q
        r, d = q - u, -s * u
        rd = dot(d, r)
        if rd == 0.0:
            return False
        self._a.append(r)
        self._b.append(d)
        self._rho.append(1.0 / rd)
        self.count += 1
        return True


class Anderson:
    """Multisecant correction of any approximate inverse M^-1, an old factorisation for one.

    With z = M^-1 R, pairs d_i (steps taken) and Z_i = M^-1 (R_i - R_i+1): u = z + sum g_i (d_i - Z_i), g the
    least-squares solution of Z g = z. Fang and Saad, Numer Linear Algebra Appl 16 (2009). ``fields``: the unknowns of
    each field, all of which count as the step's first z has made them.
    """

    def __init__(self, back: Back, options: NewtonOptions, keep: int = 12, fields: Sequence[Ints] = ()) -> None:
        self.back, self.keep, self.count, self.fields = back, keep, 0, fields
        self._d: list[Floats] = []  # in units of the fields, as Z and z
        self._Z: list[Floats] = []
        self._z: Floats | None = None
        self._scale: Floats | None = None

    def reset(self) -> None:
        self.count = 0
        self._d.clear()
        self._Z.clear()
        self._z = self._scale = None

    def begin(self) -> None:
        self._z = None

    def first(self, z: Floats) -> None:
        """Take z = M^-1 R of the present residual, its direction being found otherwise."""
        self._z = self._scaled(z)

    def _scaled(self, z: Floats) -> Floats:
        if self._scale is None:
            self._scale = weights(z, self.fields) if len(self.fields) > 1 else np.ones(1)
        return self._scale * z

    def solve(self, b: Floats) -> Floats:
        z = self._scaled(self.back(b)) if self._z is None else self._z
        self._z = z
        assert self._scale is not None
        if not self._d:
            return z / self._scale
        # normal equations with scaled columns: few columns, long vectors
        size = np.array([np.sqrt(dot(q, q)) or 1.0 for q in self._Z])
        G = np.array([[dot(a, b) for b in self._Z] for a in self._Z]) / np.outer(size, size)
        f = np.array([dot(q, z) for q in self._Z]) / size
        g = np.linalg.lstsq(G, f, rcond=1e-12)[0] / size
        out = z.copy()
        for q, d, c in zip(self._Z, self._d, g):
            out += c * (d - q)
        return out / self._scale

    def update(self, s: float, u: Floats, R0: Floats, R1: Floats) -> bool:
        z1 = self._scaled(self.back(R1))
        assert self._z is not None and self._scale is not None
        self._d.append((s * self._scale) * u)
        self._Z.append(self._z - z1)
        if len(self._d) > self.keep:
            self._d.pop(0)
            self._Z.pop(0)
        self._z = z1
        self.count += 1
        return True


METHODS: dict[str, Callable[[Back, NewtonOptions], Update]] = {
    "BFGS": BFGS, "Broyden": Broyden, "full Newton": FullNewton, "modified Newton": ModifiedNewton,
}  # fmt: skip

"""The inverse of the present tangent K, as cheap as it can be had.

A fresh factorisation applies K^-1 by one solve; one of single precision, made in half the time, is refined as its first
solve shows to be needed. A factorisation M of an earlier tangent, or of the same one at another
step size, does so by a few iterations, each a solve and a product with K, whose directions serve later right-hand sides
as well; or it stands in for K^-1 as it is, where multisecant corrections make good for it. Large factorisations cost a
hundred solves and more, so the first of these ways is taken wherever they are dear, for as long as a tangent costs less
so than all have on average since the factorisation, its own cost counted.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from .clock import Clock
from .linear.base import Floats, LinearSolver, Matrix, Precise
from .linear.krylov import Ints, Recycled, gmres, matvec
from .record import value_record, variable_record
from .vectors import norm

REUSE_RATIO = 4.0  # an old factorisation is tried for a step size within this factor of its own,
WIDE_RATIO = 50.0  # or this one where factorisations are dear
TOLERANCE = 0.03  # of a direction by an old factorisation that corrections follow
PLAIN = 1e-4  # relative error of a solve in single precision up to which later ones are not refined
ROUGH = 1e-3  # relative error of a solve in single precision from which the factorisation is made in double
LEAST, MOST = 5, 12  # bounds of the iterations of Newton given to an old factorisation before a new one is made


@value_record
class Use:
    """What is made of factorisations.

    ``exact``: relative error of K^-1 by iterations, over older ones or those of single precision (``single``); 0: each
    tangent is factorised. ``leans``: those of earlier time steps stand in for the tangent's. ``dear``: how many solves
    one costs where it is kept for later tangents. ``doubles``: there is memory for one of double precision where single
    is not enough.
    """

    exact: float = 0.0
    single: bool = False
    leans: bool = False
    dear: float = 20.0
    doubles: bool = True


FRESH = Use()
REFINED = Use(1e-6, single=True, dear=10.0)  # Newton's iterations are those of exact inverses
LEANING = Use(2e-3, single=True, leans=True)  # quasi-Newton corrections make good for the rest


@variable_record
class Factor:
    """A factorisation and the step size it was made for.

    ``tangents``: how many it has inverted, its own first; ``extra``: solves beyond one for each system, of all these,
    and ``latest``, of the last of them. ``rough``: relative error of its own tangent's first solve (of the
    field that has the largest); -1: not known.
    """

    dt: float
    solver: LinearSolver
    used: int = 0
    tangents: int = 1
    extra: int = 0
    latest: int = 0
    rough: float = -1.0
    pattern: NDArray[np.int32] | None = None
    first: NDArray | None = None  # values that the pattern was analysed with, which LU's order depends on
    last: NDArray | None = None  # values that were factorised

    @property
    def fresh(self) -> bool:
        """Is it of the tangent in use?"""
        return self.tangents == 1

    @property
    def single(self) -> bool:
        """Is it of single precision?"""
        return bool(getattr(self.solver, "single", False))

    @property
    def loose(self) -> bool:
        """Is a motion held by rounding alone? Iterations know nothing of it, nor does single precision: a pivot of
        rounding is like others there, and that pivots are looked for is all that shows."""
        stats, found = self.solver.stats, not getattr(self.solver, "pivoting", True)
        return stats.get("perturbed_pivots", 0.0) > 0.0 or bool(self.single and found and stats["pivoting"])

    def double(self) -> None:
        """The next one is of double precision."""
        cast("Precise", self.solver).single = False

    def remember(self, A: Matrix, serves: bool) -> None:
        """Keep what a checkpoint needs to make it again; ``serves``: later steps may lean on it."""
        data = A.data.astype(np.float32) if self.single else A.data
        if self.pattern is not A.indptr:
            self.pattern, self.first = A.indptr, None if A.symmetric else data.copy()
        self.last = data.copy() if serves else None

    def tired(self, cost: float) -> bool:
        """Did its last tangent take more than the mean over all, ``cost`` solves for the factorisation included?"""
        return self.latest * self.tangents > cost + self.extra


class Inverse:
    """Factorisations kept over time steps, and the one in use for the present tangent."""

    def __init__(
        self, make: Callable[[], LinearSolver], clock: Clock, use: Use = FRESH, fields: Sequence[Ints] = ()
    ) -> None:  # fmt: skip
        self._make, self._clock, self.use = make, clock, use
        self._fields = fields  # rows of each, whose errors count beside its own size
        self.solver = make()
        self._kept: list[Factor] = []
        self._uses = 0
        self._A: Matrix | None = None
        self._dt = 0.0
        self._inner: Recycled | None = None  # what inverts K by iterations
        self._at: Factor | None = None  # the factorisation in use
        self.made = 0
        self._vain = self._skip = 0  # approaches in a row that cost a factorisation; how many next ones are not tried
        self.remembers = False  # are there checkpoints?

    # ---- the present tangent ----------------------------------------------------------------------
    def factorise(self, A: Matrix, dt: float) -> None:
        """Take A as the present tangent and factorise it, in place of a factorisation that could have served it or
        of the longest unused."""
        f = self.near(dt, REUSE_RATIO)
        if f is None and len(self._kept) < self._room:
            f = Factor(dt, self._make() if self._kept else self.solver)
            self._kept.append(f)
        elif f is None:
            f = min(self._kept, key=lambda f: f.used)
        f.dt, f.tangents, f.extra, f.latest, f.rough = dt, 1, 0, 0, -1.0
        self._use(f)
        self._A, self._dt, self._inner = A, dt, None
        with self._clock("factorisation"):
            self.solver.factor(A)
        self.made += 1
        if self.remembers:
            f.remember(A, self.use.exact > 0.0)

    def approach(self, A: Matrix, dt: float) -> bool:
        """Take A as the present tangent with a factorisation at hand; False where a new one is the better way."""
        if self._inner is not None:
            self._vain = 0
        f = self.near(dt, WIDE_RATIO) if self.use.exact and self._kept and self._dear else None
        if f is None or f.tired(self.ratio) or f.rough >= ROUGH or f.loose:
            return False
        if self._skip:
            self._skip -= 1
            return False
        self._use(f)
        f.tangents, f.latest = f.tangents + 1, 0
        self._A, self._dt, self._inner = A, dt, Recycled(A, f.solver.solve, fields=self._fields)
        return True

    def near(self, dt: float, most: float = REUSE_RATIO) -> Factor | None:
        """The factorisation whose step size is nearest to ``dt``, within the factor ``most``."""
        ratios = [(max(dt / f.dt, f.dt / dt), k) for k, f in enumerate(self._kept)]
        best = min(ratios, default=(np.inf, -1))
        return self._kept[best[1]] if best[0] <= most else None

    def lean_on(self, f: Factor, A: Matrix, dt: float, b: Floats) -> tuple[Floats | None, Floats]:
        """Let f stand in for the inverse of A: K^-1 b to a few per cent (None where it does not serve), and M^-1 b."""
        self._use(f)
        self._A, self._dt, self._inner = A, dt, None
        with self._clock("linear solves"):
            x, z, error = gmres(A, b, self.solver.solve, TOLERANCE, MOST, self._fields)
        return (x if error < TOLERANCE else None), z

    def _use(self, f: Factor) -> None:
        self._uses += 1
        self.solver, self._at, f.used = f.solver, f, self._uses

    # ---- solves -----------------------------------------------------------------------------------
    def solve(self, b: Floats) -> Floats:
        """K^-1 b: by its factorisation, or by iterations; where these are slow K is factorised after all."""
        if self._inner is not None and self._spent:
            self._give_up()
        if self._inner is not None and self._at is not None and not self._at.rough < ROUGH:
            with self._clock("linear solves"):
                return self._thorough(b)
        if self._inner is not None:
            assert self._A is not None and self._at is not None
            before = self._inner.solves
            with self._clock("linear solves"):
                x, error = self._inner.solve(b, self.use.exact, self._inner_most)
            more = self._inner.solves - before - 1
            self._at.latest, self._at.extra = self._at.latest + more, self._at.extra + more
            if error <= self.use.exact or self._at.fresh:
                return x
            self._give_up()
        if self.use.leans or self._at is None or not self._at.single:
            return self.once(b)
        with self._clock("linear solves"):
            return self._improved(b, self._at)

    @property
    def _spent(self) -> bool:
        """Has the old factorisation cost the present tangent as much as a new one? Steps that lean on it have
        few systems for each tangent, and are better off with what they have."""
        at = self._at
        return not self.use.leans and at is not None and not at.fresh and at.latest > self.ratio

    def _give_up(self) -> None:
        """The old factorisation has cost the present tangent as much as a new one, or does not serve it."""
        assert self._A is not None
        if not self.use.leans:
            self._vain += 1
            self._skip = 2**self._vain - 1
        self.factorise(self._A, self._dt)

    def _improved(self, b: Floats, f: Factor) -> Floats:
        """K^-1 b by K's factorisation of single precision, as often improved as its first system tells."""
        assert self._A is not None
        x = f.solver.solve(b)
        error = f.rough
        if error < 0.0:
            more = f.solver.solve(b - matvec(self._A, x))
            x += more
            if b.any():
                parts = [(more[own], x[own]) for own in self._fields] or [(more, x)]
                f.rough = max(norm(d) / (norm(q) or 1.0) for d, q in parts)
                if not f.rough < ROUGH or f.loose:
                    return self._doubled(b, f) if self.use.doubles else self._iterated(b, f)
            return x
        while error > PLAIN:
            x += f.solver.solve(b - matvec(self._A, x))
            error *= f.rough
        return x

    def _doubled(self, b: Floats, f: Factor) -> Floats:
        """K^-1 b; K is factorised in double precision, as all will be from here on."""
        assert self._A is not None
        self.use = replace(self.use, single=False)
        f.solver.close()
        f.double()
        f.solver.factor(self._A)
        if self.remembers:
            f.remember(self._A, True)
        return f.solver.solve(b)

    def _iterated(self, b: Floats, f: Factor) -> Floats:
        """K^-1 b by iterations over K's own factorisation, as for all its systems."""
        assert self._A is not None
        self._inner = Recycled(self._A, f.solver.solve, fields=self._fields)
        return self._thorough(b)

    def _thorough(self, b: Floats) -> Floats:
        """K^-1 b by iterations over a factorisation that is rough: what rounding in its solves hides from them, and in
        the directions of other systems, is told by the residual that they leave."""
        assert self._A is not None
        inner = Recycled(self._A, self.solver.solve, fields=self._fields)
        x, before = inner.solve(b, self.use.exact, MOST)[0], np.inf
        while before > self.use.exact * norm(x):
            more = inner.solve(b - matvec(self._A, x), self.use.exact, MOST)[0]
            if not norm(more) < 0.5 * before:
                break
            x += more
            before = norm(more)
        return x

    def refined(self, b: Floats) -> Floats:
        """K^-1 b with a step of GMRES where the fresh factorisation is of single precision."""
        if self._inner is not None or self._A is None or not self.use.leans:
            return self.solve(b)
        with self._clock("linear solves"):
            return gmres(self._A, b, self.solver.solve, TOLERANCE, MOST, self._fields)[0]

    def once(self, b: Floats) -> Floats:
        """M^-1 b."""
        with self._clock("linear solves"):
            return self.solver.solve(b)

    # ---- costs ------------------------------------------------------------------------------------
    @property
    def ratio(self) -> float:
        """Solves that take as long as a factorisation: (nnz(L) / n / 170)^2, measured from 2e4 to 6e5 equations."""
        stats = self.solver.stats
        return float((stats.get("factor_entries", 0.0) / max(stats.get("equations", 1.0), 1.0) / 170.0) ** 2)

    @property
    def _dear(self) -> bool:
        """Is a factorisation dear?"""
        return self.ratio >= self.use.dear

    @property
    def worth(self) -> float:
        """Iterations of Newton that take as long as a factorisation; residual and stresses cost about a solve."""
        return float(np.clip(0.5 * self.ratio, LEAST, MOST))

    @property
    def _inner_most(self) -> int:
        """New directions for a system: a third of what a factorisation costs, since later systems have them as well."""
        return int(np.clip(self.ratio / 3.0, 6, 40))

    @property
    def _room(self) -> int:
        """Two factorisations to lean on, as steps alternate between long ones and short ones before must points; else
        one, as where they are large or the solver keeps none."""
        return 2 if self.use.leans and not self._dear and "factor_entries" in self.solver.stats else 1

    # ---- checkpoints ------------------------------------------------------------------------------
    def snapshot(self, matrix: Callable[[], Matrix]) -> Any:
        """Matrices whose factorisations a later step may use, of the pattern of ``matrix``; what is known of these."""
        out: list[dict[str, Any]] = []
        for f in self._kept:
            first, last = (f.first, f.last) if f.pattern is matrix().indptr else (None, None)
            kept = {"stats": dict(f.solver.stats), "first": first, "last": last, "single": f.single}
            out.append({"tally": (f.dt, f.used, f.tangents, f.extra, f.latest, f.rough), **kept})
        went_well = self._inner is not None
        return {"factors": out, "vain": 0 if went_well else self._vain, "skip": self._skip}

    def restore(self, saved: Any, matrix: Callable[[], Matrix]) -> None:
        """Factorise the matrices of a snapshot again."""
        self._kept, self._vain, self._skip = [], saved["vain"], saved["skip"]
        for s in saved["factors"]:
            dt, *tally = s["tally"]
            f = Factor(dt, self._make() if self._kept else self.solver, *tally)
            f.solver.stats = dict(s["stats"])
            if f.single and not s["single"]:
                f.double()
                self.use = replace(self.use, single=False)
            for values in (s["first"], s["last"]):
                if values is not None:
                    A = matrix()
                    f.pattern, A.data[:] = A.indptr, values
                    f.solver.factor(A)
            f.solver.stats, f.first, f.last = dict(s["stats"]), s["first"], s["last"]
            self._kept.append(f)
        if self._kept:
            latest = max(self._kept, key=lambda f: f.used)
            self.solver, self._uses = latest.solver, latest.used

    def close(self) -> None:
        """Free all."""
        for solver in [self.solver, *[f.solver for f in self._kept]]:
            solver.close()
        self._kept.clear()

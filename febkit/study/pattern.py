"""The published study's pattern, statement by statement: does it come out of the data at hand?"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from febkit.metrics.agreement import at_moments
from febkit.metrics.cells import METRICS
from febkit.metrics.tables import HEADINGS, Table
from febkit.model import InputError

from .config import Method
from .plan import CONTROL, Place
from .published import NRMS, SOURCE

if TYPE_CHECKING:
    import xarray as xr

EXCHANGE = "mass_exchange_rate"
STRAINS = ("effective_strain", "effective_stress", "max_shear_strain")
STILL = tuple(m for m in METRICS if m != EXCHANGE)
ALIKE = (3 / 4, 4 / 3)  # order 2 over order 1: what the study's own A and C keep to (0.77 to 1.33)
HALF = 0.5
OVER = 1.1  # median over the cells, over the control's
RAMP = 0.1  # s, the end of the ramp: "instantaneous"
NOTE = (
    f"Errors: order 2 over order 1; alike: {ALIKE[0]:.2f} to {ALIKE[1]:.2f}. Mass exchange: median over the cells over "
    f"the control's (not printed in the study); over-predicted: above {OVER:g}. Several seeds: mean [least, greatest]."
)

Named = Mapping[tuple[int | None, int | None], str]  # orders of solid and fluid -> the method's name
Numbers = Mapping[str, Sequence[float]]  # what is compared -> a value for each seed


@dataclass(frozen=True, slots=True)
class Statement:
    """One statement about one case: numbers by seed, whether it holds for each, the same numbers as published."""

    case: str
    text: str
    recovery: str
    numbers: Numbers
    holds: tuple[bool, ...]
    published: Mapping[str, float] = field(default_factory=dict)

    @property
    def verdict(self) -> str:
        n, of = sum(self.holds), len(self.holds)
        return "holds" if n == of else "does not hold" if n == 0 else f"holds for {n} of {of} seeds"

    def row(self) -> list[object]:
        printed = {k: f" ({v:.2f})" for k, v in self.published.items()}
        said = "; ".join(f"{k} {_spread(v)}{printed.get(k, '')}" for k, v in self.numbers.items())
        return [f"{self.case}: {self.text}", self.recovery, self.verdict, said]


def _spread(values: Sequence[float]) -> str:
    """The value, or with several seeds their mean and ends."""
    v = np.asarray(values, dtype=float)
    return f"{v[0]:.2f}" if len(v) == 1 else f"{v.mean():.2f} [{v.min():.2f}, {v.max():.2f}]"


def statements(
    methods: Sequence[Method],
    agreed: Mapping[Place, xr.Dataset],
    found: Mapping[Place, xr.Dataset],
    default: str = "default",
) -> Iterator[Statement]:
    """What can be said of the study's statements from agreement and metrics by place.

    ``default`` is the recovery of methods that name none. Statements that lack a method, a case or a metric are
    left out.
    """
    cases = list(dict.fromkeys(p.case for p in agreed))
    for recovery in dict.fromkeys(m.recovery or default for m in methods if m.solid is not None):
        named = {
            (m.solid, m.fluid): m.name
            for m in methods
            if (m.recovery or default) == recovery and m.solute in (None, m.fluid)
        }
        for case in cases:
            yield from _errors(case, recovery, named, agreed)
            if case in "CD":
                yield from _instantaneous(case, recovery, named, found)


def _errors(
    case: str, recovery: str, named: Named, agreed: Mapping[Place, xr.Dataset]
) -> Iterator[Statement]:
    """A, C: orders 1 and 2 alike; B, D: order 2 less than half. Ratios of RMS differences, order 2 over order 1."""
    if (1, 1) not in named or (2, 2) not in named:
        return
    pairs = [
        (agreed[p], agreed[p._replace(method=named[2, 2])])
        for p in agreed
        if p.case == case and p.method == named[1, 1] and p._replace(method=named[2, 2]) in agreed
    ]
    alike = case in "AC"
    there = [set(ds["metric"].values) for pair in pairs for ds in pair]
    names = [m for m in (STILL if alike else STRAINS) if all(m in s for s in there)]
    if not pairs or not names:
        return
    ratio = {m: [_nrms(b, m) / _nrms(a, m) for a, b in pairs] for m in names}
    within: Callable[[float], bool] = (lambda r: ALIKE[0] < r < ALIKE[1]) if alike else (lambda r: r < HALF)
    yield Statement(
        case,
        "errors of order 1 and 2 alike" if alike else "order 2 has less than half the error of order 1",
        recovery,
        {HEADINGS[m]: v for m, v in ratio.items()},
        tuple(all(within(ratio[m][k]) for m in names) for k in range(len(pairs))),
        {HEADINGS[m]: NRMS[case, 2][m] / NRMS[case, 1][m] for m in names},
    )


def _nrms(ds: xr.Dataset, metric: str) -> float:
    return float(ds["nrms"].sel(metric=metric))


def _instantaneous(
    case: str, recovery: str, named: Named, found: Mapping[Place, xr.Dataset]
) -> Iterator[Statement]:
    """C, D at 0.1 s: order 2 over-predicts the mass exchange rate, mixed order 2/1 mends it.

    Numbers are medians over the cells, over the control's.
    """
    medians: dict[str, list[float]] = {}
    orders = {"order 1": (1, 1), "order 2": (2, 2), "order 2/1": (2, 1)}
    for p in [p for p in found if p.case == case and p.method == CONTROL]:
        control = _median(found[p])
        of = {o: found.get(p._replace(method=named.get(key, ""))) for o, key in orders.items()}
        if not control or of["order 2"] is None:
            continue
        for order, ds in of.items():
            m = None if ds is None else _median(ds)
            if m is not None:
                medians.setdefault(order, []).append(m / control)
    if not medians.get("order 2"):
        return
    over = [v > OVER for v in medians["order 2"]]
    text = "order 2 over-predicts the mass exchange at 0.1 s"
    yield Statement(case, text, recovery, medians, tuple(over))
    mixed = medians.get("order 2/1", [])
    if any(over) and len(mixed) == len(over):
        mended = tuple(m <= OVER for m, o in zip(mixed, over) if o)
        yield Statement(case, "mixed order 2/1 repairs it", recovery, {"order 2/1": mixed}, mended)


def _median(ds: xr.Dataset) -> float | None:
    """Median over the cells of the mass exchange rate at the ramp's end; None where there is none."""
    if EXCHANGE not in ds:
        return None
    try:
        v = at_moments(ds, RAMP, [EXCHANGE])
    except InputError:
        return None
    return float(np.nanmedian(v[EXCHANGE].sel(moment="instantaneous")))


def table(found: Sequence[Statement]) -> Table:
    """A row for each statement."""
    return Table(
        "Pattern of the published study",
        ["statement", "recovery", "", f"numbers (in brackets from {SOURCE})"],
        [s.row() for s in found],
        NOTE,
    )


def side_by_side(found: Mapping[str, Sequence[Statement]]) -> Table:
    """A row for each statement, a column for each variant: does it hold there, by what numbers?"""
    rows: dict[tuple[str, str], dict[str, str]] = {}
    for name, said in found.items():
        for s in said:
            text, recovery, verdict, numbers = (str(x) for x in s.row())
            rows.setdefault((text, recovery), {})[name] = f"{verdict}: {numbers}"
    return Table(
        f"Pattern of the published study, variants side by side, in brackets as published ({SOURCE})",
        ["statement", "recovery", *found],
        [[*of, *(own.get(name, "") for name in found)] for of, own in rows.items()],
        NOTE,
    )


def beside_published(methods: Sequence[Method], agreed: Mapping[Place, xr.Dataset], variant: str = "") -> Table:
    """RMS differences over the control's range, ours (published); several seeds by their mean."""
    rows: list[list[object]] = []
    for case in dict.fromkeys(p.case for p in agreed):
        for m in methods:
            mine = [ds for p, ds in agreed.items() if p.case == case and p.method == m.name]
            if not mine:
                continue
            printed = NRMS.get((case, m.solid or 0), {}) if m.solid == m.fluid else {}
            row: list[object] = [f"{case} {m.name}"]
            for k in METRICS:
                values = [_nrms(ds, k) for ds in mine if k in ds["metric"].values]
                text = f"{np.mean(values):.3f}" if values else "-"
                row.append(text + (f" ({printed[k]:.3f})" if k in printed else ""))
            rows.append(row)
    title = f"RMS difference over the control's range, in brackets as published ({SOURCE})"
    title = f"{variant}: {title}" if variant else title
    return Table(title, ["", *(HEADINGS[m] for m in METRICS)], rows)

"""The published pattern is found in data that have it, and missed, with numbers, in data that do not."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from febkit.metrics import METRICS
from febkit.metrics.agreement import compare
from febkit.study import Place, pattern
from febkit.study.config import Method
from febkit.study.published import NRMS

TIMES = [0.0, 0.1, 100.0]
METHODS = tuple(Method(n, *o) for n, o in (("1", (1, 1)), ("2", (2, 2)), ("2/1", (2, 1))))
CELLS = 11


def control() -> xr.Dataset:
    """Metrics from 0 to 1, so that errors are also errors over the range; mass exchange 0.5 at 0.1 s."""
    v = np.zeros((CELLS, 3))
    v[:, 1], v[:, 2] = 0.5, np.linspace(0, 1, CELLS)
    return xr.Dataset({m: (("cell", "time"), v, {"units": "1"}) for m in METRICS},
                      {"cell": [f"cell{k}" for k in range(CELLS)], "time": TIMES})  # fmt: skip


def off(error: dict[str, float], exchange: float = 1.0) -> xr.Dataset:
    """Control plus a constant error in each metric; mass exchange at 0.1 s times ``exchange``."""
    ds = control()
    for m in METRICS:
        ds[m] = ds[m] + error.get(m, 0.0)
    rate = ds["mass_exchange_rate"]
    rate[:, 1] = 0.5 * exchange
    return ds


def study(errors: dict[tuple[str, str], dict[str, float]], exchange: dict[tuple[str, str], float], seeds: int = 1):
    """Agreement and metrics by place of cases with these errors."""
    found, agreed = {}, {}
    for (case, method), e in errors.items():
        for s in range(seeds):
            at = Place(case, method, 0, s)
            found[at._replace(method="control")] = control()
            found[at] = off(e, exchange.get((case, method), 1.0))
            agreed[at] = compare(control(), found[at])
    return agreed, found


def as_published() -> tuple[dict, dict]:
    errors = {(c, str(o)): dict(v) for (c, o), v in NRMS.items()}
    errors |= {(c, "2/1"): errors[c, "2"] for c in "ABCD"}
    exchange = {(c, m): x for c in "CD" for m, x in (("1", 0.97), ("2", 1.4), ("2/1", 1.02))}
    return errors, exchange


def test_the_published_numbers_have_the_published_pattern():
    agreed, found = study(*as_published())
    said = list(pattern.statements(METHODS, agreed, found))
    assert [s.case for s in said] == ["A", "B", "C", "C", "C", "D", "D", "D"]
    assert {s.verdict for s in said} == {"holds"}
    b = said[1]
    assert b.numbers["effective strain"] == [pytest.approx(0.128 / 0.318)]
    assert "effective strain 0.40 (0.40)" in str(b.row()[3])
    assert said[3].numbers["order 2"] == [pytest.approx(1.4)]
    text = pattern.table(said).markdown()
    assert "order 1 0.97; order 2 1.40; order 2/1 1.02" in text


@pytest.mark.parametrize(("case", "metric", "value"), [
    ("A", "volumetric_strain", 0.02), ("A", "effective_strain", 0.1), ("B", "max_shear_strain", 0.17),
    ("C", "aspect_ratio_change", 0.02), ("D", "effective_stress", 0.15),
])  # fmt: skip
def test_one_error_that_breaks_a_statement_is_found(case, metric, value):
    errors, exchange = as_published()
    errors[case, "2"] = errors[case, "2"] | {metric: value}
    said = list(pattern.statements(METHODS, *study(errors, exchange)))
    broken = [s for s in said if s.verdict != "holds"]
    assert [(s.case, s.verdict) for s in broken] == [(case, "does not hold")]
    ratio = [v for k, v in broken[0].numbers.items() if k.replace(" ", "_") in metric]
    assert ratio[0][0] == pytest.approx(value / NRMS[case, 1][metric])


def test_mass_exchange_that_is_not_over_predicted():
    errors, exchange = as_published()
    exchange["C", "2"], exchange["D", "2/1"] = 0.9, 1.3
    said = [s for s in pattern.statements(METHODS, *study(errors, exchange)) if "mass" in s.text or "mixed" in s.text]
    assert [(s.case, s.verdict) for s in said] == [
        ("C", "does not hold"), ("D", "holds"), ("D", "does not hold")]  # nothing to repair in C


def test_seeds_are_counted():
    agreed, found = study(*as_published(), seeds=3)
    at = Place("B", "2", 0, 1)
    agreed[at] = compare(control(), off(dict.fromkeys(METRICS, 0.3)))
    b = next(s for s in pattern.statements(METHODS, agreed, found) if s.case == "B")
    assert b.verdict == "holds for 2 of 3 seeds"
    assert "0.58 [0.40, 0.94] (0.40)" in str(b.row()[3])


def test_what_cannot_be_said_is_left_out():
    errors, exchange = as_published()
    only = {k: v for k, v in errors.items() if k[1] == "2"}
    agreed, found = study(only, exchange)
    said = list(pattern.statements(METHODS[1:2], agreed, found))
    assert [s.case for s in said] == ["C", "D"]  # the mass exchange needs no order 1
    late = {p: ds.isel(time=[0, 2]) for p, ds in found.items()}
    assert not list(pattern.statements(METHODS[1:2], agreed, late))
    dry = {p: ds.drop_vars("mass_exchange_rate") for p, ds in found.items()}
    assert not list(pattern.statements(METHODS[1:2], agreed, dry))


def test_recoveries_are_told_apart():
    errors, exchange = as_published()
    methods = (*METHODS, Method("1 element", 1, 1, "element"), Method("2 element", 2, 2, "element"))
    errors |= {("B", "1 element"): errors["B", "1"], ("B", "2 element"): errors["B", "1"]}
    said = [s for s in pattern.statements(methods, *study(errors, exchange), default="patches") if s.case == "B"]
    assert [(s.recovery, s.verdict) for s in said] == [("patches", "holds"), ("element", "does not hold")]


def test_table_2_beside_ours():
    agreed, _ = study(*as_published())
    t = pattern.beside_published(METHODS, agreed)
    rows = {str(r[0]): r for r in t.rows}
    assert rows["D 2"][t.columns.index("effective strain")] == "0.133 (0.133)"
    assert rows["D 2/1"][t.columns.index("effective strain")] == "0.133"  # not printed in the study


def test_variants_stand_side_by_side():
    errors, exchange = as_published()
    found = {"fine": list(pattern.statements(METHODS, *study(errors, exchange)))}
    errors["B", "2"] = dict.fromkeys(METRICS, 0.3)
    found["coarse"] = list(pattern.statements(METHODS, *study({k: errors[k] for k in errors if k[0] == "B"}, exchange)))
    t = pattern.side_by_side(found)
    assert t.columns == ["statement", "recovery", "fine", "coarse"] and len(t.rows) == 8
    b = next(r for r in t.rows if str(r[0]).startswith("B"))
    assert str(b[2]).startswith("holds: effective strain 0.40 (0.40)")
    assert str(b[3]).startswith("does not hold: effective strain 0.94 (0.40)")
    assert all(r[3] == "" for r in t.rows if r is not b)  # of the others it has nothing

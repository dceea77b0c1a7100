"""Unit systems are consistent, symbols resolve to units, and units convert."""

from __future__ import annotations

import pytest

from febkit.model import InputError
from febkit.units import SYSTEMS, factor, measures, one, system


@pytest.mark.parametrize("name", SYSTEMS)
def test_every_system_is_consistent(name: str) -> None:
    """F = M L/t^2, P = F/L^2, E = F L, W = E/t and c = n/L^3 hold without a factor."""
    s = SYSTEMS[name]
    for derived, made in (("F", "M.L/t^2"), ("P", "F/L^2"), ("E", "F.L"), ("W", "E/t"), ("c", "n/L^3")):
        assert factor(s.of(derived), s.of(made)) == 1.0, derived
    if name != "CGS":  # FEBio Studio's currents of CGS are none that go with its potentials
        assert factor(s.of("W"), s.of("V.I")) == 1.0
    assert s.water == {"m": 1e18, "mm": 1e9, "um": 1.0, "cm": 1e12}[s.of("L")]


@pytest.mark.parametrize(
    ("symbol", "want"),
    [("L/t^2", "mm/s^2"), ("L^4/F.t", "mm^4/(N s)"), ("1", "1"), ("", ""), ("L/L", "1"), ("L/L^2", "1/mm"),
     ("P/L^2", "MPa/mm^2"), ("n/L^2.t", "nmol/(mm^2 s)"), ("F.L", "N mm")],
)  # fmt: skip
def test_symbols(symbol: str, want: str) -> None:
    assert SYSTEMS["mm-N-s"].of(symbol) == want


def test_a_unit_that_is_a_fraction_stays_one() -> None:
    assert SYSTEMS["CGS"].of("P.t") == "dyn s/cm^2" and SYSTEMS["CGS"].of("L^3/P") == "cm^5/dyn"


@pytest.mark.parametrize(
    ("a", "b", "want"),
    [("MPa", "kPa", 1e3), ("Pa", "kPa", 1e-3), ("mm^3", "um^3", 1e9), ("dyn/cm^2", "kPa", 1e-4), ("m", "m", 1.0),
     ("tonne/s", "pg/s", 1e18), ("N/m^2", "MPa", 1e-6), ("mm^4/(N s)", "m^4/(N s)", 1e-12), ("degC", "degC", 1.0)],
)  # fmt: skip
def test_factors(a: str, b: str, want: float) -> None:
    assert factor(a, b) == want


@pytest.mark.parametrize(("a", "b"), [("mm", "s"), ("", "kPa"), ("inch", "mm"), ("kPa", "kPa/s"), ("degC", "K")])
def test_what_cannot_be_converted(a: str, b: str) -> None:
    with pytest.raises(InputError):
        factor(a, b)
    assert not measures(a, b)


def test_names() -> None:
    assert system("SI") is SYSTEMS["SI"] and system("inch") is system(None) is system("") is None
    assert one(None, "SI", "", "SI", what="they") == "SI" and one(None, what="they") is None
    with pytest.raises(InputError, match="they differ in units: SI and CGS"):
        one("SI", "CGS", what="they")

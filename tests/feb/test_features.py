"""The census of FEBio's types: it is whole, its answers are lowering's, and every type survives reading and writing."""

from __future__ import annotations

import csv
import io

import pytest

from febkit import census
from febkit.feb import check_features, features, modules
from febkit.feb.difference import diff
from febkit.feb.read import read_bytes
from febkit.feb.writer import to_bytes
from febkit.model.reasons import reason
from helpers.forked import febkit

MADE = [k for k in census.everything() if k not in census.TABLES]


def test_every_registered_type_is_of_fluids_or_listed():
    table, listed = features.table(), modules.registered()
    fluids = modules._lists(modules.FLUIDS)
    for kind, name in modules.KINDS.items():
        if kind != "load":
            elsewhere = set(table["discrete_material"]) if kind == "material" else set()
            assert set(table[kind]) - elsewhere == set(listed[name]) | set(fluids.get(kind, ()))
            assert set(fluids.get(kind, ())) <= set(table[kind])
    within = {t for names in modules._lists(modules.WITHIN).values() for t in names}
    assert within <= set(features.anywhere())


@pytest.mark.parametrize("kind", [k for k in MADE if k not in ("domain", "element", "linear solver")])
def test_an_invented_type_is_refused(kind):
    """Domains without a formulation and solvers of linear equations have no effect on what is solved."""
    assert not census.solves(kind, "invented")


@pytest.mark.parametrize(("kind", "name", "solved"), [
    ("material", "neo-Hookean", True), ("material", "multiphasic", True), ("load", "pressure", True),
    ("load", "surface attraction", False), ("contact", "sliding-elastic", True), ("contact", "mortar-tied", False),
    ("element", "hex20", True), ("element", "tri10", True), ("element", "line3", True), ("permeability", "perm-Holmes-Mow", True),
    ("solver", "solid", True), ("solver tag", "cgmethod", False), ("mesh adaptor", "mmg_remesh", False),
])  # fmt: skip
def test_what_is_solved(kind, name, solved):
    assert name in census.everything()[kind]
    assert census.solves(kind, name) is solved


@pytest.mark.parametrize("kind", MADE)
def test_every_type_is_known_and_goes_through_version_3(kind):
    """Read, checked, written in another version and read again: the same model, or what is lost is said."""
    for name in census.everything()[kind]:
        for text in census._models(kind, name):
            model = read_bytes(text.encode())
            data, lost = to_bytes(model, "3.0")
            assert lost or not diff(model, read_bytes(data)), (name, text)
        assert any(not _unknown(text) for text in census._models(kind, name)), name


def test_what_is_not_solved_has_a_reason_and_little_is_not():
    """No plot variable or log item is missing; of the others at least nine in ten are there."""
    entries = list(census.census())
    assert not [e for e in entries if not e.solved and not reason(e.name)]
    read = [e for e in entries if e.kind in ("plot variable", "log item")]
    assert all(e.solved for e in read)
    others = [e.solved for e in entries if e not in read]
    assert sum(others) >= 0.9 * len(others)


def _unknown(text: str) -> list[str]:
    said = [f.message for f in check_features.check(read_bytes(text.encode()))]
    return [m for m in said if "unknown" in m or "is not a parameter" in m]


def test_the_command_lists_counts_and_what_is_missing(tmp_path):
    said = febkit("features", "contacts", "--missing", "--style", "csv", folder=tmp_path)
    rows = list(csv.DictReader(io.StringIO(said.stdout)))
    assert said.returncode == 0 and {r["kind"] for r in rows} == {"contact"}
    assert "mortar-tied" in {r["type"] for r in rows} and "sliding-elastic" not in {r["type"] for r in rows}
    bad = febkit("features", "contactz", folder=tmp_path)
    assert bad.returncode == 2 and "no kind is called" in bad.stderr and "contact" in bad.stderr

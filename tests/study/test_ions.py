"""Studies of charged mixtures: the example, its moments, its first table, and what is the published study's alone."""

from __future__ import annotations

from pathlib import Path

from febkit import study
from febkit.metrics import METRICS, compare
from febkit.model import Where
from febkit.study import Place, ions, pattern, report
from febkit.study.config import Method

from .test_pattern import control, off

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_the_example_hands_ions_over_and_ends_its_ramp_when_the_template_does():
    plan = study.make_plan(study.read(EXAMPLES / "study_triphasic.toml"))
    assert report.mixed(plan) and report.ramp(plan) == 10.0
    drives = [s for s in plan.steps().values() if s.kind == "drive"]
    orders = {(s.params["solid"], s.params["fluid"], s.params.get("solute")) for s in drives}
    assert orders == {(1, 1, None), (2, 2, None), (2, 2, 1)} and len(drives) == 6
    plan = study.make_plan(study.read(EXAMPLES / "study_reduced.toml"))
    assert not report.mixed(plan) and report.ramp(plan) == 0.1


def test_orders_of_solutes_do_not_stand_for_the_orders_of_the_published_study():
    """Order 2 of all fields is the study's order 2, not 2/2/1, whichever comes last."""
    methods = [Method.parse(m, Where("study.toml")) for m in ("1", "2", "2/2/1")]
    agreed = {Place("B", m.name): compare(control(), off(dict.fromkeys(METRICS, e)))
              for m, e in zip(methods, (0.4, 0.1, 0.35))}  # fmt: skip
    (said,) = pattern.statements(methods, agreed, {})
    assert said.verdict == "holds"


def test_errors_stand_by_case_and_method():
    agreed = {Place(c, m): compare(control(), off(dict.fromkeys(METRICS, e)))
              for c, m, e in (("B", "1", 0.4), ("B", "2", 0.1), ("D", "1", 0.2))}  # fmt: skip
    table = ions.table(agreed)
    assert list(table.columns) == ["", "B 1", "B 2", "D 1"]
    by = {r[0]: r[1:] for r in table.rows}
    assert by["largest"] == [float(agreed[p].nrms.max()) for p in agreed]
    assert by["effective strain"][1] == agreed[Place("B", "2")].nrms.sel(metric="effective_strain").item()


def test_one_cell_has_no_ranks():
    plan = study.make_plan(study.read(EXAMPLES / "study_reduced.toml"))
    many = {Place("B", m): control() for m in ("control", "1", "2")}
    one = {p: ds.isel(cell=[0]) for p, ds in many.items()}
    assert [label for label, _ in report._ranks(plan, many)] == ["B: 1 / 2"]
    assert list(report._ranks(plan, one)) == []

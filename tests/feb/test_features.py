"""The census of FEBio's types: it is whole, its answers are lowering's, and every type survives reading and writing."""

from __future__ import annotations

import csv
import io
from xml.sax.saxutils import quoteattr

import pytest

from febkit import census
from febkit.feb import check_features, features, modules
from febkit.feb.difference import diff
from febkit.feb.read import read_bytes
from febkit.feb.writer import to_bytes
from helpers.forked import febkit

SOLID = census.USUAL["solid"]
FIELDS = {"points": census.POINTS, "module": "multiphasic", "more": "", "kind": "Solid", "element": "hex8",
          "nodes": census.SOLID[1], "domain": "", "control": "", "sections": "", "analysis": "transient"}  # fmt: skip


def _solid(type_, inside):
    return f'<material id="1" name="m" type="{type_}">{inside}</material>'


def _solute(inside):
    return census.MULTIPHASIC.replace("<diffusivity", f"{inside}<diffusivity", 1)


# where a type of a kind stands: in a material or the output
PLACES = {
    "permeability": census.USUAL["biphasic"].replace('perm-const-iso"><perm>1</perm>', '{}">'),
    "solvent supply": census.USUAL["biphasic"].replace("</material>", '<solvent_supply type="{}"/></material>'),
    "diffusivity": census.MULTIPHASIC.replace('diff-const-iso"><free_diff>1</free_diff><diff>1</diff>', '{}">'),
    "solubility": census.MULTIPHASIC.replace('solub-const"><solub>1</solub>', '{}">'),
    "osmotic coefficient": census.MULTIPHASIC.replace('osm-coef-const"><osmcoef>1</osmcoef>', '{}">'),
    "solute supply": _solute('<supply type="{}"/>'),
    "reaction": census.MULTIPHASIC.replace("</material>", '<reaction type="{}"/></material>'),
    "reaction rate": census.MULTIPHASIC.replace("</material>", '<reaction type="mass-action-forward"><forward_rate '
                                                'type="{}"/></reaction></material>'),
    "active contraction": _solid("trans iso Mooney-Rivlin", '<active_contraction type="{}"/>'),
    "bond relaxation": _solid("reactive viscoelastic", '<relaxation type="{}"/>'),
    "bond recruitment": _solid("reactive viscoelastic", '<recruitment type="{}"/>'),
    "damage distribution": _solid("elastic damage", '<damage type="{}"/>'),
    "damage criterion": _solid("elastic damage", '<criterion type="{}"/>'),
    "fiber distribution": _solid("continuous fiber distribution", '<distribution type="{}"/>'),
    "fiber material": _solid("continuous fiber distribution", '<fibers type="{}"/>'),
    "integration scheme": _solid("continuous fiber distribution", '<scheme type="{}"/>'),
    "growth tensor": _solid("kinematic growth", '<growth type="{}"/>'),
    "plastic flow curve": _solid("reactive plasticity", '<flow_curve type="{}"/>'),
    "prestrain gradient": _solid("prestrain elastic", '<prestrain type="{}"/>'),
    "solid supply": _solid("remodeling solid", '<supply type="{}"/>'),
    "axes": _solid("orthotropic elastic", '<mat_axis type="{}"/>'),
    "direction": _solid("fiber-NH", '<mu>1</mu><fiber type="{}"/>'),
}  # fmt: skip
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
    ("element", "hex20", True), ("element", "tri10", True), ("element", "line3", True),
    ("permeability", "perm-Holmes-Mow", True), ("solver", "solid", True), ("solver tag", "cgmethod", True),
    ("solver tag", "preconditioner", False),
    ("mesh adaptor", "mmg_remesh", False),
])  # fmt: skip
def test_what_is_solved(kind, name, solved):
    assert name in census.everything()[kind]
    assert census.solves(kind, name) is solved


@pytest.mark.parametrize("kind", [*MADE, *PLACES])
def test_every_type_is_known_and_goes_through_other_versions(kind):
    """Read, checked, written in each version and read again: the same model, or what is lost is said.

    (Optimisation methods stand in no model but in FEBio's file of a fit: tests/fitting.)
    """
    for name in census.everything()[kind]:
        texts = list(_texts(kind, name))
        for text in texts:
            model = read_bytes(text.encode())
            for version in ("4.0", "3.0"):
                data, lost = to_bytes(model, version)
                assert lost or not diff(model, read_bytes(data)), (name, version, text)
        assert any(not _unknown(text) for text in texts), name


def _texts(kind, name):
    """Small models that have a type of a kind."""
    if kind in PLACES:
        yield census.MODEL.format(**FIELDS | {"material": PLACES[kind].format(name)})
    else:
        yield from census._models(kind, name)


def test_every_output_is_known_and_goes_through_other_versions():
    """All plot variables, log items and data records in one model."""
    kinds = census.everything()
    plots, logs, records = (kinds[k] for k in ("plot variable", "log item", "data record"))
    asked = [f'<plotfile type="febio">{"".join(f"<var type={quoteattr(n)}/>" for n in plots)}</plotfile><logfile>']
    asked += [f"<element_data data={quoteattr(n)}/>" for n in logs] + [f'<{n} data="x"/>' for n in records]
    text = census.MODEL.format(**FIELDS | {"material": SOLID})
    text = text.replace('<Edge name="e"><line2 id="1">1,2</line2></Edge>', "")
    text = text.replace("</febio_spec>", f"<Output>{''.join(asked)}</logfile></Output></febio_spec>")
    model = read_bytes(text.encode())
    assert not list(check_features.check(model))
    for version in ("4.0", "3.0", "2.5"):
        data, lost = to_bytes(model, version)
        out = read_bytes(data).output
        assert not lost and [v.type for v in out.plot] == list(plots)
        assert [e.data for e in out.log] == [*logs, *["x"] * len(records)]


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

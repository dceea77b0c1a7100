"""Models with values, attributes and tags damaged at random end in a sentence with a place, or lowered."""

from __future__ import annotations

import os
import random
from pathlib import Path

import pytest

from helpers import cube
from helpers.mutants import VALUES, attempt, damaged, not_finite, run

COUNT = int(os.environ.get("FEBKIT_MUTANTS", "600"))
SEED = int(os.environ.get("FEBKIT_SEED", "7"))
DATA = sorted((Path(__file__).parents[1] / "feb" / "data").glob("*.feb"))
FIBERS = """<material id="1" name="m" type="uncoupled solid mixture"><k>10</k>
<solid type="Mooney-Rivlin"><c1>1</c1><c2>0.1</c2></solid>
<solid type="continuous fiber distribution uncoupled"><fibers type="fiber-exp-pow-uncoupled"><alpha>0</alpha>
<beta>2</beta><ksi>1</ksi></fibers><distribution type="ellipsoidal"><spa>1,1,1</spa></distribution>
<scheme type="fibers-3d-gkt"><nph>7</nph><nth>31</nth></scheme></solid></material>"""
MIXED = """<material id="1" name="m" type="biphasic"><phi0>0.2</phi0><fluid_density>1</fluid_density>
<mat_axis type="local">1,2,4</mat_axis>
<solid type="coupled trans-iso Mooney-Rivlin"><c1>1</c1><c2>0</c2><c3>1</c3><c4>1</c4>
<c5>1</c5><lam_max>1.1</lam_max><k>10</k><fiber type="local">1,2</fiber></solid>
<permeability type="perm-ref-iso"><perm0>1</perm0><perm1>0</perm1><perm2>0</perm2><M>0</M>
<alpha>2</alpha></permeability>
</material>"""
MAPPED = '<material id="1" name="m" type="neo-Hookean"><E type="map">stiff</E><v>0</v></material>'
MORE = """<Initial><ic type="velocity" node_set="top"><value>0,0,1</value></ic></Initial>
<Loads><surface_load type="pressure" surface="face"><pressure lc="1">0.1</pressure><linear>0</linear></surface_load>
<nodal_load type="nodal_load" node_set="top"><dof>x</dof><scale lc="1">1</scale></nodal_load>
<body_load type="body force"><force type="math">0,0,-X*t</force></body_load></Loads>
<Discrete><discrete_material id="1" name="s" type="nonlinear spring"><measure>strain</measure><force type="point">
<interpolate>linear</interpolate><points><pt>0,0</pt><pt>1,1</pt></points></force></discrete_material>
<discrete dmat="1" discrete_set="d"/></Discrete>
<Constraints><constraint type="linear constraint"><laugon>AUGLAG</laugon><tol>0.1</tol><penalty>1</penalty>
<linear_constraint><node id="1" bc="x">1</node><node id="2" bc="x">-1</node></linear_constraint></constraint>
</Constraints>
<LoadData><load_controller id="1" type="loadcurve"><interpolate>SMOOTH</interpolate><extend>REPEAT</extend>
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller>
<load_controller id="2" type="math"><math>sin(t)</math></load_controller></LoadData>"""
SETS = """<Surface name="face"><quad4 id="1">5,6,7,8</quad4></Surface>
<DiscreteSet name="d"><delem>1,5</delem></DiscreteSet><ElementSet name="all">1</ElementSet></Mesh>"""
MAPS = """</MeshDomains><MeshData><ElementData name="stiff" elem_set="all"><e lid="1">3</e></ElementData></MeshData>"""


def originals() -> list[bytes]:
    more = [cube.text(FIBERS, more=MORE), cube.text(MIXED, module="biphasic"),
            cube.text(MAPPED, more=MORE)]
    made = [t.replace("</Mesh>", SETS).replace("</MeshDomains>", MAPS).encode() for t in more]
    return [*made, *(p.read_bytes() for p in DATA)]


def test_the_originals_are_sound() -> None:
    assert [attempt(data) for data in originals()[:3]] == ["lowered"] * 3


def test_damaged_models_end_in_a_sentence_or_a_problem() -> None:
    report = run(originals(), COUNT, SEED)
    said = "\n".join(f"{what}\n{data.decode(errors='replace')}" for what, data in report.faults[:3])
    assert report.faults == [], said
    assert report.ends["refused"] > COUNT / 5
    assert report.ends["lowered"] > COUNT / 20


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_what_the_run_looks_for_is_found(bad: float) -> None:
    """A problem that holds a number that is none is told by its place."""
    assert not_finite({"a": (1.0, [2.0, bad])}) == "problem['a'][1][1]"


def test_the_values_tried_get_into_the_models() -> None:
    """Numbers that are none, too, stand in some of the mutants, where the original has none of them."""
    rng, original = random.Random(SEED), originals()[0]
    mutants = [damaged(original, rng) for _ in range(300)]
    for bad in (b"nan", b"1e309"):
        assert bad in VALUES and bad not in original and any(b">" + bad + b"<" in m for m in mutants)

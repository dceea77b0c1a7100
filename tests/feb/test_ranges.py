"""Parameter ranges and dead ends: what FEBio refuses is refused before solving, by validate and run alike."""

import re
from dataclasses import replace

import numpy as np
import pytest

import febkit
from febkit.feb import read
from febkit.feb.features import anywhere
from febkit.feb.validation import check, validate
from febkit.model import InputError, ranges
from febkit.solver.solids import registry
from helpers import cube, forked

NEO = '<material id="1" name="m" type="neo-Hookean"><E>{}</E><v>{}</v></material>'
MOONEY = '<material id="1" name="m" type="Mooney-Rivlin"><c1>1</c1><c2>0</c2>{}</material>'
ORTHO = """<material id="1" name="m" type="orthotropic elastic"><E1>1</E1><E2>1</E2><E3>1</E3><G12>1</G12><G23>1</G23>
<G31>1</G31><v12>{}</v12><v23>0</v23><v31>0</v31></material>"""
BIPHASIC = """<material id="1" name="m" type="biphasic"><phi0>{}</phi0>
<solid type="neo-Hookean"><E>1</E><v>0.3</v></solid>
<permeability type="perm-const-iso"><perm>{}</perm></permeability></material>"""
GROWN = """<material id="1" name="m" type="reactive viscoelastic"><kinetics>{}</kinetics><trigger>0</trigger>
<elastic type="neo-Hookean"><E>1</E><v>0.3</v></elastic><bond type="neo-Hookean"><E>1</E><v>0.3</v></bond>
<relaxation type="relaxation-exponential"><tau>1</tau></relaxation></material>"""
CONTROL = "<time_steps>1</time_steps><step_size>1</step_size>"
WRONG = {
    "E": (cube.text(NEO.format(-0.6, 0.3)), "<E> of neo-Hookean must be more than 0, not -0.6"),
    "v": (cube.text(NEO.format(1, 0.7)), r"<v> of neo-Hookean must be in \[-1, 0.5\), not 0.7"),
    "v 0.5": (cube.text(NEO.format(1, 0.5)), r"must be in \[-1, 0.5\), not 0.5"),
    "no E": (cube.text(NEO.format("", 0.3).replace("<E></E>", "")), '<material type="neo-Hookean"> lacks <E>'),
    "no k": (cube.text(MOONEY.format("")), "lacks <k>, the bulk modulus of the whole"),
    "k 0": (cube.text(MOONEY.format("<k>0</k>")), "the bulk modulus of the whole, must be more than 0"),
    "k -1": (cube.text(MOONEY.format("<k>-1</k>")), "<k> of Mooney-Rivlin must be at least 0, not -1"),
    "v12": (cube.text(ORTHO.format(1.5)), r"<v12> of orthotropic elastic must be at most sqrt\(E1/E2\) = 1, not 1.5"),
    "phi0": (cube.text(BIPHASIC.format(1.5, 1), module="biphasic"), r"<phi0> of biphasic must be in \[0, 1\], not 1.5"),
    "perm": (cube.text(BIPHASIC.format(0.2, -1), module="biphasic"), "<perm> of perm-const-iso must be at least 0"),
    "kinetics": (cube.text(GROWN.format(3)), r"<kinetics> of reactive viscoelastic must be in \[1, 2\], not 3"),
    "steps": (cube.text(NEO.format(1, 0), control="<time_steps>-5</time_steps>"), "must be at least -1, not -5"),
    "rtol": (
        cube.text(NEO.format(1, 0), control=CONTROL + '<solver type="solid"><rtol>-1</rtol></solver>'),
        "<rtol> of <solver> must be at least 0, not -1",
    ),
    "no dof": (
        cube.text(NEO.format(1, 0)).replace("_dof>1<", "_dof>0<"),
        '<bc type="zero displacement"> holds no degree of freedom',
    ),
    "type": (cube.text(NEO.format(1, 0).replace("neo-Hookean", "neo-Hokean")), 'did you mean "neo-Hookean"'),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_febio_refuses_is_an_error(tmp_path, name):
    content, message = WRONG[name]
    (tmp_path / "m.feb").write_text(content)
    found = [f for f in validate(tmp_path / "m.feb", solvable=True) if f.severity == "error"]
    assert re.search(message, found[0].message)
    assert found[0].where.line > 1
    with pytest.raises(InputError) as e:
        febkit.solve(febkit.read(tmp_path / "m.feb"))
    assert str(e.value) == f"{found[0].where}: {found[0].message}"


@pytest.mark.parametrize("name", ["E", "phi0", "type"])
def test_run_and_validate_say_the_same(tmp_path, name):
    content, message = WRONG[name]
    (tmp_path / "m.feb").write_text(content)
    said = [forked.febkit(verb, "m.feb", folder=tmp_path) for verb in ("validate", "run")]
    sentence = re.search(r"m\.feb:\d+: error: (.*)", said[0].stdout)
    assert sentence is not None and re.search(message, sentence[1])
    assert [s.returncode for s in said] == [2, 2]
    assert sentence[1] in said[1].stderr
    assert not list(tmp_path.glob("*.xplt"))


def test_words_of_an_enumeration_count_as_their_numbers(tmp_path):
    """"Type I" was kept as text and taken for type II."""
    for text, number in (("Type I", 1), ("type ii", 2), ("1", 1)):
        block = cube.problem(tmp_path, cube.text(GROWN.format(text))).blocks[0]
        assert block.solid.kinetics == number


def test_values_with_a_curve_or_a_formula_are_not_refused(tmp_path):
    """FEBio looks at constants only; a map's values are doubted."""
    curve = '<load_controller id="1" type="loadcurve"><points><pt>0,0</pt></points></load_controller>'
    curve = f"<LoadData>{curve}</LoadData>"
    ok = [cube.text(NEO.format(1, 0.3).replace("<E>", '<E lc="1">'), more=curve), cube.text(NEO.format("X-2", 0.3))]
    mapped = cube.text(NEO.format("stiff", 0.3).replace("<E>", '<E type="map">'))
    rows = '<MeshData><ElementData name="stiff" elem_set="cube"><e lid="1">-3</e></ElementData></MeshData>'
    ok.append(mapped.replace("</MeshDomains>", "</MeshDomains>" + rows))
    said = []
    for content in ok:
        (tmp_path / "m.feb").write_text(content)
        found = validate(tmp_path / "m.feb", solvable=True)
        assert not [f for f in found if f.severity == "error"]
        said += [f.message for f in found if "stiff" in f.message]
    assert said == ['<E> of neo-Hookean must be more than 0; the map "stiff" holds -3']


def test_ranges_are_of_parameters_that_there_are():
    """Each type of the table is one of FEBio's, and has the parameter."""
    known = anywhere()
    for type_ in ranges._lines():
        admitted = ranges.of(type_)
        assert admitted
        if not type_.startswith("("):
            assert set(admitted) <= known[type_], type_


def test_the_solver_has_its_ranges():
    """The moduli of the commonest solids are bounded, by the names that the solver knows them by."""
    for type_, tag in (("neo-Hookean", "E"), ("Mooney-Rivlin", "k"), ("Holmes-Mow", "v"), ("Ogden", "m1")):
        assert registry.known("solid", type_)
        assert tag in ranges.of(type_)


@pytest.mark.parametrize(("text", "inside", "outside"), [
    (">0", (1e-300,), (0.0, -1.0)), (">=2", (2.0,), (1.99,)), ("[-1,0.5)", (-1.0, 0.49), (0.5, -1.1)),
    ("(0,1]", (1.0,), (0.0,)), ("!=0", (-1.0,), (0.0,)), ("[0,1/3]", (1 / 3,), (0.34,)),
    ("{0..2,7}", (1.0, 7.0), (3.0, 0.5)),
])
def test_how_ranges_are_written(text, inside, outside):
    r = ranges._range(text)
    assert all(map(r.holds, inside)) and not any(map(r.holds, outside))
    assert not r.holds(float("nan"))


def test_a_model_that_nothing_drives_or_holds_is_doubted(tmp_path):
    """As FEBio does ("No force acting on the system"); run says it, too, and solves."""
    (tmp_path / "m.feb").write_text(cube.text(NEO.format(1, 0.3)))
    done = forked.febkit("run", "m.feb", folder=tmp_path)
    assert done.returncode == 0
    assert "nothing drives the model" in " ".join((done.stdout + done.stderr).split())
    free = re.sub(r"<Boundary>.*?</Boundary>", "", cube.text(NEO.format(1, 0.3)), flags=re.S)
    (tmp_path / "m.feb").write_text(free)
    assert any("nothing holds the model" in f.message for f in validate(tmp_path / "m.feb"))


def test_very_many_steps_are_doubted(tmp_path):
    control = "<time_steps>2000000000</time_steps><step_size>1</step_size>"
    (tmp_path / "m.feb").write_text(cube.text(NEO.format(1, 0.3), control=control))
    said = [f.message for f in validate(tmp_path / "m.feb") if f.severity == "warning"]
    assert any("2000000000 time steps are asked for" in s and "23.1 days" in s for s in said)


@pytest.mark.parametrize("bad", [-1, 8])
def test_nodes_that_there_are_not_are_refused_in_memory(tmp_path, bad):
    """A model made in Python may name any; the solver would read past its arrays."""
    (tmp_path / "m.feb").write_text(cube.text(NEO.format(1, 0.3)))
    m = read(tmp_path / "m.feb")
    block = m.mesh.blocks[0]
    conn = block.conn.copy()
    conn[0, 3] = bad
    broken = replace(m, mesh=replace(m.mesh, blocks=(replace(block, conn=conn),)))
    assert [f.severity for f in check(broken)] == ["error"]
    with pytest.raises(InputError, match=f'part "cube" refers to node index {bad}; the mesh has 8 nodes'):
        febkit.solve(broken)
    X = m.mesh.X.copy()
    X[2, 1] = np.nan
    with pytest.raises(InputError, match="finite position"):
        febkit.solve(replace(m, mesh=replace(m.mesh, X=X)))


def test_a_part_without_elements_is_left_out(tmp_path):
    text = cube.text(NEO.format(1, 0.3))
    more = text.replace("</Elements>", '</Elements><Elements type="hex8" name="none"></Elements>')
    more = more.replace("</MeshDomains>", '<SolidDomain name="none" mat="m"/></MeshDomains>')
    assert [b.name for b in cube.problem(tmp_path, more).blocks] == ["cube"]
    assert any('part "none" has no elements' in f.message for f in validate(tmp_path / "cube.feb"))
    bare = re.sub(r"<elem .*?</elem>", "", text)
    with pytest.raises(InputError, match="no elements to solve for"):
        cube.problem(tmp_path, bare)


def test_words_for_flags_are_doubted(tmp_path):
    """FEBio reads the digits of a flag, so that "true" is 0 there; it is 1 here."""
    text = cube.text(NEO.format(1, 0.3)).replace("<x_dof>1<", "<x_dof>true<")
    said = [f for f in (validate_text(tmp_path, text)) if 'reads "true" as 0' in f.message]
    assert [f.severity for f in said] == ["warning"]
    assert [c.column for c in cube.problem(tmp_path, text).common.conditions] == [0, 1, 2]


def validate_text(folder, text):
    (folder / "m.feb").write_text(text)
    return validate(folder / "m.feb", solvable=True)

"""Each kind of mistake is found, at its line; sound files are left in peace."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from febkit.feb import read, validate
from febkit.feb.features import anywhere, table

V4 = Path(__file__).parent / "data" / "two_blocks_40.feb"
TEXT = V4.read_text()
E2 = '<elem id="2">5,6,7,8,9,10,11,12</elem>'


@pytest.mark.parametrize(("old", "new", "severity", "said"), [
    ("<E>1.5</E>", "<Ee>1.5</Ee>", "error", "<Ee> is not a parameter of neo-Hookean"),
    ("neo-Hookean", "neo-Hokean", "error", 'did you mean "neo-Hookean"'),
    ('type="zero displacement" node_set="bottom"', 'type="zero displacement" node_set="botom"', "error", '"botom"'),
    ('surface="front"', 'surface="frnt"', "error", 'no surface "frnt"'),
    ('surface_pair="sides"', 'surface_pair="side"', "error", 'no surface pair "side"'),
    ("<primary>left</primary>", "<primary>lft</primary>", "error", 'no surface "lft"'),
    ('<pressure lc="1">', '<pressure lc="7">', "error", "no load controller 7"),
    ('<pressure lc="1">0.2', '<pressure type="map">m', "error", 'no map "m"'),
    ('<pressure lc="1">0.2', '<pressure type="math">2*(X', "error", "missing at the end"),
    ('<SolidDomain name="Part2" mat="Material2"/>', "", "error", 'part "Part2" has no domain'),
    ('mat="Material2"', 'mat="Material1"', "warning", 'material "Material2" belongs to no domain'),
    ('mat="Material2"', 'mat="Material9"', "error", 'no material "Material9"'),
    ("<rb>Material3</rb>", "<rb>Material1</rb>", "error", 'no rigid body material "Material1"'),
    (E2, '<elem id="2">9,10,11,12,5,6,7,8</elem>', "error", "inside out"),
    (E2, '<elem id="1">5,6,7,8,9,10,11,12</elem>', "warning", "element id 1 is used 2 times"),
    (E2, '<elem id="2">1,2,3,4,5,6,7,8</elem><elem id="3">1,2,3,4,5,6,7,8</elem>', "warning", "have the nodes of"),
    (E2, '<elem id="2">1,2,3,4,5,6,7,8</elem>', "warning", "4 nodes belong to no element, first node 9"),
    ('<load_controller id="2"', '<load_controller id="3"', "error", "count from 1 without gaps"),
    ("<time_steps>10</time_steps>", "<time_steps>0</time_steps>", "error", "must be at least 1"),
    ("<time_steps>10</time_steps>", "<time_step>10</time_step>", "error", 'did you mean "time_steps"'),
    ("<Boundary>", "<Boundry/><Boundary>", "error", "<Boundry> is no section"),
    ('<e lid="1">', '<e lid="4">', "error", "lid=4 lies outside"),
    ('<bc name="push" type="prescribed displacement"', '<bc name="push" type="prescribed displacement" set="a"',
     "error", "unknown attribute set="),
    ('<var type="stress"/>', '<var type="strss"/>', "warning", 'did you mean "stress"'),
    ('discrete_set="springs"', 'discrete_set="sprigs"', "error", 'no discrete set "sprigs"'),
    ('node_set="bottom"></node_data>', 'node_set="none"></node_data>', "error", '"none"'),
    ('<Module type="solid"/>', "", "error", "first section must be <Module>"),
    ("<max_refs>", "<max_refz>", "error", ""),
])
def test_mistakes_are_found(tmp_path, old, new, severity, said):
    assert old in TEXT
    text = TEXT.replace(old, new, 1).replace("<max_refz>15</max_refs>", "<max_refz>15</max_refz>")
    path = tmp_path / "m.feb"
    path.write_text(text)
    found = [f for f in validate(path) if f.severity == severity and said in f.message]
    assert found, [str(f) for f in validate(path)]
    line = text[:text.index(new.split(">")[0])].count("\n") + 1 if new else 1
    if found[0].where.line:
        assert abs(found[0].where.line - line) <= 2 or any(w in said for w in ("domain", "gaps", "first"))


def test_a_long_formula_is_pointed_out(tmp_path):
    long = "+".join(f"abs(t-0.{i})" for i in range(100, 180))
    (tmp_path / "m.feb").write_text(TEXT.replace('<pressure lc="1">0.2', f'<pressure type="math">{long}'))
    assert any("characters" in f.message and f.severity == "warning" for f in validate(tmp_path / "m.feb"))


def test_a_set_that_names_an_id_used_twice_is_an_error(tmp_path):
    text = TEXT.replace(E2, '<elem id="1">5,6,7,8,9,10,11,12</elem>')
    text = text.replace("</Mesh>", '<ElementSet name="one">1</ElementSet></Mesh>')
    (tmp_path / "m.feb").write_text(text)
    (found,) = [f for f in validate(tmp_path / "m.feb") if "used 2 times" in f.message]
    assert found.severity == "error" and 'element set "one"' in found.message


def test_a_material_that_formulas_read_needs_no_domain(tmp_path):
    numbers = '<material id="4" name="numbers" type="neo-Hookean"><density>1</density><E>1</E><v>0</v></material>'
    text = TEXT.replace("</Material>", numbers + "</Material>")
    (tmp_path / "m.feb").write_text(text)
    said = 'material "numbers" belongs to no domain'
    assert [f.severity for f in validate(tmp_path / "m.feb") if f.message == said] == ["warning"]
    formula = """<pressure type="math">2*${fem.material('numbers').E}"""
    (tmp_path / "m.feb").write_text(text.replace('<pressure lc="1">0.2', formula))
    assert said not in [f.message for f in validate(tmp_path / "m.feb")]


def test_what_febkit_cannot_solve_is_said_with_its_line(tmp_path):
    text = V4.read_text().replace('type="sliding-node-on-facet"', 'type="tied-fluid"')
    (tmp_path / "m.feb").write_text(text)
    found = [f for f in validate(tmp_path / "m.feb", solvable=True) if f.severity == "unsupported"]
    line = next(i for i, row in enumerate(text.splitlines(), 1) if "tied-fluid" in row)
    assert any("tied-fluid" in f.message and f.where.line == line for f in found)


def test_unreadable_files_give_one_error(tmp_path):
    (tmp_path / "m.feb").write_text(TEXT.replace("</Mesh>", "", 1))
    found = validate(tmp_path / "m.feb")
    assert len(found) == 1 and found[0].severity == "error" and found[0].where.line > 0


def test_units_are_hinted_at(tmp_path):
    assert any(f.severity == "hint" and "units" in f.message for f in validate(V4))
    (tmp_path / "m.feb").write_text(TEXT.replace('<Module type="solid"/>',
                                                 '<Module type="solid"><units>mm-N-s</units></Module>'))
    assert validate(tmp_path / "m.feb") == []
    assert read(tmp_path / "m.feb").units == "mm-N-s"


def test_the_tables_know_the_usual_types():
    t = table()
    assert {"E", "v", "density"} <= t["material"]["neo-Hookean"]
    assert {"solid", "permeability", "phi0", "fluid_density"} <= t["material"]["biphasic"]
    assert t["bc"]["prescribed displacement"] == {"dof", "value", "relative"}
    assert "perm" in anywhere()["perm-const-iso"] and "stress" in t["plot"]
    assert {"max_refs", "dtol", "qn_method", "ptol"} <= t["solver"]["biphasic"]


def test_command_line(tmp_path):
    from febkit.cli.validate import command

    run = CliRunner().invoke(command, [str(V4), "--no-solver"])
    assert run.exit_code == 0 and "hint" in run.output
    (tmp_path / "m.feb").write_text(TEXT.replace('surface="front"', 'surface="x"'))
    run = CliRunner().invoke(command, [str(tmp_path / "m.feb"), "-q", "--no-solver"])
    assert run.exit_code == 2 and 'no surface "x"' in run.output

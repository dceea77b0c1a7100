"""One model, spelled by hand in five versions of the format, means the same in each."""

from itertools import product
from pathlib import Path

import pytest

from febkit.feb import diff, read, read_bytes, to_bytes, validate
from febkit.feb.convert import VERSIONS
from febkit.model import InputError

DATA = Path(__file__).parent / "data"
FILES = {v: DATA / f"two_blocks_{v.replace('.', '')}.feb" for v in VERSIONS}
# older versions have no names for what conditions list in place
NAMES = ("node set", "surface", "element set")


def meaning(a, b):
    """Differences, names of sets aside: what refers to a set is compared by the members of it."""
    return [d for d in diff(a, b) if not (d.what.startswith(NAMES) and "missing" in (d.a, d.b))]


@pytest.mark.parametrize("version", VERSIONS)
def test_all_versions_mean_the_same(version):
    model = read(FILES[version])
    assert model.version == version
    assert meaning(read(FILES["4.0"]), model) == []


@pytest.mark.parametrize(("source", "target"), [p for p in product(VERSIONS, VERSIONS) if p[0] != p[1]])
def test_every_conversion_keeps_the_meaning_and_loses_nothing(source, target):
    model = read(FILES[source])
    data, notes = to_bytes(model, target)
    again = read_bytes(data)
    assert again.version == target and meaning(model, again) == []
    lost = [n for n in notes if not n.startswith("sets that no condition uses")]
    assert lost == []
    assert b"the same model in every version" in data  # the remark on top


@pytest.mark.parametrize("version", VERSIONS)
def test_hand_made_files_are_sound(version):
    assert {f.severity for f in validate(FILES[version])} <= {"hint"}


def test_the_records_of_an_old_file_are_those_of_version_4():
    m = read(FILES["1.2"])
    assert [(b.name, b.type, b.ids.tolist()) for b in m.mesh.blocks] == [("Part1", "hex8", [1]), ("Part2", "hex8", [2])]
    assert [c.type for c in m.common.boundary] == ["zero displacement", "prescribed displacement", "rigid"]
    assert m.common.boundary[1].child("value").lc == 1
    assert m.common.boundary[2].str("rb") == "Material3"
    assert {c.type for c in m.common.rigid} == {"rigid_fixed", "rigid_displacement"}
    assert m.controllers[1].points == ((0.0, 0.0), (0.5, 2.0), (1.0, 0.001))
    assert m.controllers[1].spec.str("interpolate") == "STEP"
    control = m.steps[0].control
    assert control.child("solver").child("qn_method").int("max_ups") == 10
    assert control.str("analysis") == "STATIC"


def test_what_a_version_cannot_say_is_listed():
    text = FILES["4.0"].read_bytes()
    text = text.replace(b'<load_controller id="1" type="loadcurve">', b'<load_controller id="1" type="math">')
    text = text.replace(b"<interpolate>LINEAR</interpolate>", b"<math>2*t</math>", 1)
    text = text.replace(b'<Module type="solid"/>', b'<Module type="solid"><units>SI</units></Module>')
    model = read_bytes(text)
    assert to_bytes(model, "3.0")[1] == []
    notes = to_bytes(model, "2.5")[1]
    assert len(notes) == 2 and any("load controller 1" in n for n in notes) and any("units" in n for n in notes)


@pytest.mark.parametrize(("again", "sound"), [('<node id="1"/><node id="2"/>', True), ('<node id="2"/>', False)])
def test_a_set_given_again_counts_once(again: str, sound: bool) -> None:
    """FEBio 4.11 takes it in version 2.5; of two that differ conditions and loads would mean different ones there."""
    first = '<NodeSet name="two"><node id="1"/><node id="2"/></NodeSet>'
    text = FILES["2.5"].read_text().replace("</Geometry>", f'{first}<NodeSet name="two">{again}</NodeSet></Geometry>')
    if sound:
        assert read_bytes(text.encode()).mesh.node_sets["two"].nodes.tolist() == [0, 1]
        return
    with pytest.raises(InputError, match="defined twice"):
        read_bytes(text.encode())


@pytest.mark.parametrize("name", ["", ' name="Element thickness"'])
def test_element_data_fill_what_var_says(tmp_path: Path, name: str) -> None:
    """A name beside it, as febio-python writes one, counts for nothing in FEBio."""
    path = tmp_path / "shell.feb"
    path.write_text(f"""<febio_spec version="3.0"><Module type="solid"/>
<Material><material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material></Material>
<Mesh><Nodes name="all"><node id="1">0,0,0</node><node id="2">1,0,0</node><node id="3">0,1,0</node></Nodes>
<Elements type="tri3" name="p"><elem id="1">1,2,3</elem></Elements></Mesh>
<MeshDomains><ShellDomain name="p" mat="m"/></MeshDomains>
<MeshData><ElementData elem_set="p"{name} var="shell thickness">
<elem lid="1">0.1,0.2,0.3</elem></ElementData></MeshData>
</febio_spec>""")
    (data,) = read(path).mesh_data
    assert data.name == "shell thickness" and data.values.tolist() == [[0.1, 0.2, 0.3]]


def test_the_thickness_of_shells_is_element_data_in_version_3():
    """FEBio 4.11 leaves <shell_thickness> unused in files of version 3.0."""
    model = read(FILES["4.0"])
    shell = (b'<Elements type="quad4" name="skin"><elem id="901">1,2,3,4</elem></Elements></Mesh>',
             b'<ShellDomain name="skin" mat="m"><shell_thickness>0.02</shell_thickness></ShellDomain></MeshDomains>')
    data = to_bytes(model, "4.0")[0].replace(b"</Mesh>", shell[0]).replace(b"</MeshDomains>", shell[1])
    model = read_bytes(data)
    old, _ = to_bytes(model, "3.0")
    assert b"<shell_thickness>" not in old
    assert b'<ElementData var="shell thickness" elem_set="skin">' in old
    assert b'<e lid="1">0.02,0.02,0.02,0.02</e>' in old
    assert diff(model, read_bytes(old)) == []


def test_steps_survive_the_way_down_and_up():
    text = FILES["4.0"].read_text()
    control = text[text.index("<Control>"):text.index("</Control>") + 10]
    steps = "<Step>" + "".join(f'<step id="{i}" name="s{i}">{control}</step>' for i in (1, 2)) + "</Step>"
    model = read_bytes(text.replace(control, "").replace("<LoadData>", steps + "<LoadData>").encode())
    assert len(model.steps) == 2
    for version in VERSIONS:
        again = read_bytes(to_bytes(model, version)[0])
        assert len(again.steps) == 2 and meaning(model, again) == []


@pytest.mark.parametrize("version", ["0.9", "4.1", "5.0", "", "x"])
def test_unknown_versions_are_refused(version):
    from febkit.model import InputError

    with pytest.raises(InputError, match="version"):
        read_bytes(f'<febio_spec version="{version}"></febio_spec>'.encode())
    with pytest.raises(InputError, match="version"):
        to_bytes(read(FILES["4.0"]), version or "none")

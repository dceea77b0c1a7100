"""Reading: lists by numpy or by XML, sets, places in the file, errors with file and line."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from febkit.feb import read, read_bytes
from febkit.feb.document import parse
from febkit.model import InputError
from febkit.model.sets import element_ids, node_indices

V4 = Path(__file__).parent / "data" / "two_blocks_40.feb"
TEXT = V4.read_text()


def mesh(*sections, nodes=10):
    rows = "".join(f'<node id="{i}">{i}.5,{i * i},-1e-3</node>\n' for i in range(1, nodes + 1))
    body = f"<Nodes>\n{rows}</Nodes>" + "".join(sections)
    return f'<febio_spec version="4.0"><Module type="solid"/>\n<Mesh>\n{body}</Mesh></febio_spec>'.encode()


def test_places_are_those_of_the_file():
    m = read(V4)
    lines = TEXT.splitlines()
    for c in (*m.materials, *m.common.boundary, *(x for b in m.common.boundary for x in b)):
        assert f"<{c.tag}" in lines[c.where.line - 1] and c.where.file == str(V4)
    for b in m.mesh.blocks:
        assert f'name="{b.name}"' in lines[b.where.line - 1]


def test_long_lists_are_read_alike_with_and_without_numpy():
    quick = read_bytes(mesh(nodes=200))
    slow = read_bytes(mesh(nodes=200).replace(b'<node id="7">', b'<!-- by hand --><node  id="7">'))
    assert parse(mesh(nodes=200)).root.child("Mesh").child("Nodes").table is not None
    np.testing.assert_array_equal(quick.mesh.X, slow.mesh.X)
    np.testing.assert_array_equal(quick.mesh.node_ids, np.arange(1, 201))
    assert quick.mesh.X[6].tolist() == [7.5, 49.0, -1e-3]


@pytest.mark.parametrize("row", [
    '<node id="5">1,2</node>', '<node id="5">1,2,3,4</node>', '<node id="5">1,2,x</node>', '<node id="5">1,,3</node>',
    '<node id="5">1,2,nan</node>', '<node id="5">1,2,1e999</node>', '<node id="x">1,2,3</node>', "<node>1,2,3</node>",
    '<node id="3">1,2,3</node>', '<nude id="5">1,2,3</nude>', '<node id="1e30">1,2,3</node>',
    '<node id="5">1.2.3,4</node>',
])
def test_bad_rows_are_refused_with_their_line(row):
    good = mesh(nodes=30)
    bad = good.replace(b'<node id="5">5.5,25,-1e-3</node>', row.encode())
    assert bad != good
    with pytest.raises(InputError) as e:
        read_bytes(bad, "m.feb")
    assert e.value.where.file == "m.feb" and 3 <= e.value.where.line <= 9


def test_scattered_ids():
    ids = [3, 7, 2 * 10**9, 2 * 10**9 + 5]
    rows = "".join(f'<node id="{i}">{k},0,0</node>' for k, i in enumerate(ids))
    text = (f'<febio_spec version="4.0"><Mesh><Nodes name="all">{rows}</Nodes><Elements type="TET4" name="P">'
            f'<elem id="9">{",".join(map(str, reversed(ids)))}</elem></Elements></Mesh></febio_spec>')
    m = read_bytes(text.encode())
    assert m.mesh.blocks[0].conn.tolist() == [[3, 2, 1, 0]] and m.mesh.blocks[0].type == "tet4"
    with pytest.raises(InputError, match="node 8"):
        read_bytes(text.replace(">7,", ">7,").replace("2000000005,2000000000,7,3",
                                                      "2000000005,2000000000,8,3").encode())


def test_sets_and_references():
    sections = (
        '<Elements type="hex8" name="P"><elem id="4">1,2,3,4,5,6,7,8</elem></Elements>',
        '<NodeSet name="n">1:3, 7\n 9</NodeSet>', '<Surface name="s"><quad4 id="1">1,2,3,4</quad4>'
        '<tri3 id="2">2,3,9</tri3></Surface>', '<Edge name="e"><line2 id="1">10,9</line2></Edge>',
        '<ElementSet name="es">4</ElementSet>', '<DiscreteSet name="d"><delem>1,10</delem></DiscreteSet>',
        '<SurfacePair name="sp"><primary>s</primary><secondary>s</secondary></SurfacePair>',
        '<PartList name="pl">P</PartList>')
    m = read_bytes(mesh(*sections)).mesh
    assert (m.node_sets["n"].nodes + 1).tolist() == [1, 2, 3, 7, 9]
    assert {k: (v + 1).tolist() for k, v in m.surfaces["s"].facets.items()} == {
        "quad4": [[1, 2, 3, 4]], "tri3": [[2, 3, 9]]}
    assert (node_indices(m, "@surface:s") + 1).tolist() == [1, 2, 3, 4, 9]
    assert (node_indices(m, "@edge:e") + 1).tolist() == [10, 9]
    assert (node_indices(m, "@elem_set:es") + 1).tolist() == list(range(1, 9))
    assert (node_indices(m, "@part_list:pl") + 1).tolist() == list(range(1, 9))
    assert element_ids(m, "P").tolist() == element_ids(m, "@part_list:pl").tolist() == [4]
    assert m.discrete_sets["d"].pairs.tolist() == [[0, 9]] and m.surface_pairs["sp"].primary == "s"
    for missing in ("x", "@surface:x", "@edge:x", "@elem_set:x", "@part_list:x", "@odd:x"):
        with pytest.raises(InputError):
            node_indices(m, missing)


def test_maps():
    part = "".join(f'<elem id="{i}">1,2,3,4,5,6,7,8</elem>' for i in range(1, 13))
    rows = "".join(f'<e lid="{i}">{i / 4},0,1</e>' for i in range(1, 13))
    axes = '<e lid="2"><a>1,0,0</a><d>0,1,0</d></e>'
    text = mesh(f'<Elements type="hex8" name="P">{part}</Elements>').replace(b"</febio_spec>", (
        f'<MeshData><ElementData name="f" elem_set="P" data_type="vec3">{rows}</ElementData>'
        f'<ElementData type="mat_axis" elem_set="P">{axes}</ElementData>'
        '<ElementData type="shell thickness" elem_set="P"><e lid="1">1,2,3</e><e lid="2">4,5,6,7</e></ElementData>'
        '<NodeData name="g" type="math" node_set="@elem_set:P"><math>X^2</math></NodeData></MeshData>'
        "</febio_spec>").encode())
    f, q, h, g = read_bytes(text).mesh_data
    assert f.values.shape == (12, 3) and f.values[3].tolist() == [1.0, 0.0, 1.0] and f.items[0] == 1
    assert q.values.tolist() == [[1, 0, 0, 0, 1, 0]] and q.name == "mat_axis" and q.items.tolist() == [2]
    assert np.isnan(h.values[0, 3]) and h.values[1].tolist() == [4, 5, 6, 7]
    assert g.values is None and g.kind == "node" and g.spec.str("math") == "X^2"


def test_output_and_control():
    extra = ('<Output><logfile file="a.log"><node_data data="x;y" name="pos" delim=",">1,5:9:2</node_data></logfile>'
             '<plotfile type="vtk"><var type="fluid pressure=p"/><var type="stress" surface="front"/>'
             "<compression>1</compression></plotfile></Output>")
    start, stop = TEXT.index("<Output>"), TEXT.index("</Output>") + 9
    o = read_bytes((TEXT[:start] + extra + TEXT[stop:]).encode()).output
    assert [(v.type, v.alias, v.surface) for v in o.plot] == [("fluid pressure", "p", None), ("stress", None, "front")]
    assert o.plot_type == "vtk" and o.plot_spec.int("compression") == 1 and o.log_file == "a.log"
    assert o.log[0].items == (1, 5, 7, 9) and o.log[0].delim == "," and o.log[0].name == "pos"


@pytest.mark.parametrize(("text", "line", "said"), [
    ("", 0, "empty"), ("<a/>", 1, "no .feb file"), ("<febio_spec>", 1, ""), ("\n<febio_spec/>", 2, "version"),
    ('<febio_spec version="4.0">\n<Mesh>\n<Nodes/>\n</Mesh></febio_spec>', 2, "no nodes"),
    ('<febio_spec version="4.0">\n\n<Mesh></febio_spec>', 3, "well-formed"),
    ("\xff\xfe\x00", 0, ""), ('<febio_spec version="4.0">' + "<a>" * 500, 1, "deep"),
])
def test_broken_files_are_refused(text, line, said):
    with pytest.raises(InputError) as e:
        read_bytes(text.encode("latin-1"), "m.feb")
    assert said in e.value.message and e.value.where.file == "m.feb" and (not line or e.value.where.line == line)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="cannot open"):
        read(tmp_path / "none.feb")


def test_reading_and_checking_do_not_load_the_compiler():
    code = ("import sys; from febkit.feb import read, validate, to_bytes;"
            f"m = read({str(V4)!r}); validate({str(V4)!r}); to_bytes(m, '2.5');"
            "print([x for x in ('numba', 'scipy', 'xarray', 'meshio', 'lxml') if x in sys.modules])")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"

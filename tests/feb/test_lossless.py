"""Untouched files come back byte for byte; an edit touches only what it changes."""

import difflib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from febkit.feb import diff, read, read_bytes, to_bytes
from febkit.model import Component

DATA = sorted((Path(__file__).parent / "data").glob("*.feb"))
V4 = Path(__file__).parent / "data" / "two_blocks_40.feb"


def changed(model):
    """Lines taken out and put in, and whether the result reads back as the edited model."""
    old, new = model.document.data.decode().splitlines(), to_bytes(model)[0].decode().splitlines()
    rows = list(difflib.unified_diff(old, new, n=0, lineterm=""))[2:]
    assert diff(model, read_bytes(to_bytes(model)[0])) == []
    return [r[1:].strip() for r in rows if r[0] == "-"], [r[1:].strip() for r in rows if r[0] == "+"]


@pytest.mark.parametrize("path", DATA, ids=lambda p: p.stem)
def test_untouched_files_come_back_byte_for_byte(path, tmp_path):
    from febkit.feb import write

    write(read(path), tmp_path / "out.feb")
    assert (tmp_path / "out.feb").read_bytes() == path.read_bytes()


@pytest.mark.parametrize("encoding", ["utf-8", "iso-8859-1", "utf-16"])
def test_encodings_survive(encoding):
    text = V4.read_text().replace("ISO-8859-1", encoding).replace('name="floor"', 'name="größe"')
    data = text.encode(encoding)
    model = read_bytes(data)
    assert model.common.boundary[0].name == "größe"
    assert to_bytes(model)[0] == data


def test_one_parameter():
    m = read(V4)
    material = m.materials[0]
    children = tuple(replace(c, text="2.5") if c.tag == "E" else c for c in material.children)
    edited = replace(m, materials=(replace(material, children=children), *m.materials[1:]))
    assert changed(edited) == (["<E>1.5</E>"], ["<E>2.5</E>"])


def test_one_attribute():
    m = read(V4)
    bc = m.common.boundary
    edited = replace(m, common=replace(m.common, boundary=(replace(bc[0], attrs={"node_set": "top"}), *bc[1:])))
    assert changed(edited) == (['<bc name="floor" type="zero displacement" node_set="bottom">'],
                               ['<bc name="floor" type="zero displacement" node_set="top">'])


def test_one_condition_more_and_one_less():
    m = read(V4)
    bc = m.common.boundary
    new = Component("bc", "zero fluid pressure", "drain", attrs={"node_set": "top"})
    more = replace(m, common=replace(m.common, boundary=(*bc, new)))
    assert changed(more) == ([], ['<bc name="drain" type="zero fluid pressure" node_set="top"/>'])
    less = replace(m, common=replace(m.common, boundary=bc[:2]))
    out, into = changed(less)
    assert into == [] and out[0].startswith('<bc name="glue"') and len(out) == 3


def test_a_load_curve_and_a_set():
    m = read(V4)
    curve = replace(m.controllers[0], points=((0.0, 0.0), (2.0, 3.0)))
    out, into = changed(replace(m, controllers=(curve, *m.controllers[1:])))
    assert out == ["<point>1,1</point>"] and into == ["<point>2,3</point>"]
    sets = dict(m.mesh.node_sets)
    del sets["corner"]
    edited = replace(m, mesh=replace(m.mesh, node_sets=sets))
    old, new = m.document.data, to_bytes(edited)[0]
    assert old.replace(b'\n\t\t<NodeSet name="corner">6</NodeSet>', b"") == new


def test_moved_nodes_leave_the_rest_alone():
    m = read(V4)
    X = m.mesh.X.copy()
    X[3] += 0.25
    out, into = changed(replace(m, mesh=replace(m.mesh, X=X)))
    assert all(r.startswith("<node") for r in out + into) and len(out) == len(into) == 12


def test_a_new_section_stands_where_febio_expects_it():
    m = read(V4)
    ic = Component("ic", "velocity", attrs={"node_set": "top"}, children=(Component("value", text="0,0,1"),))
    data = to_bytes(replace(m, common=replace(m.common, initial=(ic,))))[0]
    order = [data.index(f"<{s}>".encode()) for s in ("MeshDomains", "MeshData", "Initial", "Boundary")]
    assert order == sorted(order)


def test_comments_and_unknown_sections_survive_edits():
    text = V4.read_text().replace("<Boundary>", "<!-- mine --><Odd a='1'>\n <x>  1 </x></Odd>\n<Boundary><!-- bc -->")
    m = read_bytes(text.encode())
    assert [u.tag for u in m.unknown] == ["Odd"]
    data = to_bytes(replace(m, materials=m.materials[:2]))[0].decode()
    assert "<!-- mine --><Odd a='1'>\n <x>  1 </x></Odd>\n<Boundary><!-- bc -->" in data
    assert "rigid body" not in data


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_edit_reads_back(data):
    m = read(V4)
    texts = st.from_regex(r"[A-Za-z0-9.,<>&\" ]{1,12}", fullmatch=True).map(str.strip).filter(bool)
    materials = list(m.materials)
    for _ in range(data.draw(st.integers(1, 3))):
        i = data.draw(st.integers(0, len(materials) - 1))
        c = materials[i]
        kids = list(c.children)
        what = data.draw(st.sampled_from(["text", "drop", "add", "name", "swap"]))
        j = data.draw(st.integers(0, len(kids) - 1)) if kids else 0
        if what == "text" and kids:
            kids[j] = replace(kids[j], text=data.draw(texts))
        elif what == "drop" and kids:
            del kids[j]
        elif what == "add":
            kids.insert(j, Component("extra", text=data.draw(texts)))
        elif what == "swap" and len(kids) > 1:
            kids[0], kids[-1] = kids[-1], kids[0]
        name = data.draw(texts) if what == "name" else c.name
        materials[i] = replace(c, name=name, children=tuple(kids))
    edited = replace(m, materials=tuple(materials))
    again = read_bytes(to_bytes(edited)[0])

    def bare(c):
        return c.tag, c.type, c.name, c.id, c.text, dict(c.attrs), tuple(map(bare, c.children))

    assert [bare(c) for c in again.materials] == [bare(c) for c in edited.materials]
    np.testing.assert_array_equal(again.mesh.X, m.mesh.X)

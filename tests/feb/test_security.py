"""Hostile inputs: bombs, external entities, includes that leave the model's folder."""

import os
import time

import pytest

from febkit.feb import read, read_bytes
from febkit.model import InputError

BOMB = """<?xml version="1.0"?>
<!DOCTYPE lolz [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">
<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">]>
<febio_spec version="4.0"><Module type="&c;"/></febio_spec>"""
EXTERNAL = """<?xml version="1.0"?>
<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/passwd">]>
<febio_spec version="4.0"><Module type="&e;"/></febio_spec>"""
SECTION = '<febio_spec version="2.5"><Module type="solid"/>\n{}</febio_spec>'


@pytest.mark.parametrize("text", [
    BOMB, EXTERNAL, '<!DOCTYPE febio_spec SYSTEM "http://localhost/x.dtd"><febio_spec version="4.0"/>',
    "<!DOCTYPE febio_spec><febio_spec version='4.0'/>",
])
def test_declarations_are_refused(text):
    with pytest.raises(InputError, match="DOCTYPE"):
        read_bytes(text.encode())


def test_unknown_entities_are_refused():
    with pytest.raises(InputError, match="well-formed"):
        read_bytes(b'<febio_spec version="4.0"><Module type="&secret;"/></febio_spec>')


@pytest.mark.parametrize("name", ["../outside.feb", "/etc/passwd", "sub/../../outside.feb", "..\\outside.feb",
                                  "link.feb"])
@pytest.mark.parametrize("form", ["<Include>{}</Include>", '<Geometry from="{}"/>'])
def test_includes_stay_inside_the_folder(tmp_path, name, form):
    outside = tmp_path / "outside.feb"
    outside.write_text(SECTION.format("<Geometry/>"))
    folder = tmp_path / "model"
    (folder / "sub").mkdir(parents=True)
    (folder / "link.feb").symlink_to(outside)
    (folder / "m.feb").write_text(SECTION.format(form.format(name)))
    with pytest.raises(InputError, match="outside"):
        read(folder / "m.feb")


def test_includes_that_go_round_are_refused(tmp_path):
    (tmp_path / "a.feb").write_text(SECTION.format("<Include>b.feb</Include>"))
    (tmp_path / "b.feb").write_text(SECTION.format("<Include>a.feb</Include>"))
    with pytest.raises(InputError, match="includes itself"):
        read(tmp_path / "a.feb")


def test_a_bomb_of_includes_is_refused(tmp_path):
    """26 small files that include the next one twice would be read 2^26 times."""
    for k in range(26):
        twice = f"<Include>d{k + 1}.feb</Include>" * 2 if k < 25 else ""
        (tmp_path / f"d{k}.feb").write_text(SECTION.format(twice))
    start = time.perf_counter()
    with pytest.raises(InputError, match="more than 500 files"):
        read(tmp_path / "d0.feb")
    assert time.perf_counter() - start < 5.0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_pipes_and_devices_are_not_read(tmp_path):
    """A named pipe that nobody writes to, and /dev/zero, never end."""
    os.mkfifo(tmp_path / "pipe.feb")
    (tmp_path / "m.feb").write_text(SECTION.format("<Include>pipe.feb</Include>"))
    for name in ("m.feb", "pipe.feb"):
        with pytest.raises(InputError, match="no regular file"):
            read(tmp_path / name)
    with pytest.raises(InputError, match="no regular file"):
        read("/dev/zero")


def test_included_sections_are_read(tmp_path):
    from pathlib import Path

    from febkit.feb import diff

    whole = Path(__file__).parent / "data" / "two_blocks_25.feb"
    text = whole.read_text()
    geometry = text[text.index("<Geometry>"):text.index("</Geometry>") + 11]
    material = text[text.index("<Material>"):text.index("</Material>") + 11]
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "geometry.feb").write_text(SECTION.format(geometry))
    (tmp_path / "material.feb").write_text(f'<febio_spec version="2.5">{material}</febio_spec>')
    text = text.replace(geometry, '<Geometry from="parts/geometry.feb"/>')
    (tmp_path / "m.feb").write_text(text.replace(material, "<Include>material.feb</Include>"))
    assert diff(read(whole), read(tmp_path / "m.feb")) == []


def test_memory_of_ids_and_ranges_is_bounded():
    head = '<febio_spec version="4.0"><Mesh><Nodes><node id="2147483647">0,0,0</node></Nodes>'
    assert len(read_bytes(f"{head}</Mesh></febio_spec>".encode()).mesh.node_ids) == 1
    with pytest.raises(InputError, match="range"):
        read_bytes(f'{head}<NodeSet name="s">1:999999999999</NodeSet></Mesh></febio_spec>'.encode())
    many = ",".join(["1:9999999"] * 10)
    with pytest.raises(InputError, match="range"):
        read_bytes(f'{head}<NodeSet name="s">{many}</NodeSet></Mesh></febio_spec>'.encode())


@pytest.mark.parametrize("text", [
    '<Nodes><node id="2147483648">0,0,0</node></Nodes>',
    "<Nodes>{}</Nodes>".format("".join(f'<node id="{2147483640 + k}">0,0,0</node>' for k in range(9))),
    '<Nodes><node id="1">0,0,0</node></Nodes><ElementSet name="s">2147483648</ElementSet>',
])
def test_ids_that_32_bits_do_not_hold_are_refused(text):
    """Plotfiles keep ids in 32 bits: a larger one would come back as another."""
    with pytest.raises(InputError, match=r"2147483648.*2147483647"):
        read_bytes(f'<febio_spec version="4.0"><Mesh>{text}</Mesh></febio_spec>'.encode(), "m.feb")


@pytest.mark.parametrize("row", ['<node id="1">1_0,0,0</node>', '<node id="1_0">0,0,0</node>',
                                 '<node id="\u0661">0,0,0</node>', '<node id="1">\u0661,0,0</node>'])
def test_numbers_are_spelt_as_in_c(row):
    """Python reads 1_0 as 10 and digits of any alphabet; FEBio does not."""
    text = f'<febio_spec version="4.0"><Mesh><Nodes>{row}</Nodes></Mesh></febio_spec>'
    with pytest.raises(InputError, match=r"m\.feb:1"):
        read_bytes(text.encode(), "m.feb")

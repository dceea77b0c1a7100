"""<Contact>: what is read, what is refused by name and place."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from febkit.lower import lower, unsupported
from febkit.model import InputError
from helpers import cube

MATERIAL = '<material id="1" name="m" type="neo-Hookean"><density>1</density><E>2</E><v>0.3</v></material>'


def content(contact: str, pair: str = "faces") -> str:
    text = cube.text(MATERIAL, more=f"<Contact>{contact}</Contact>")
    sides = (
        '<Surface name="below"><quad4 id="1">1,4,3,2</quad4></Surface>'
        '<Surface name="above"><quad4 id="1">5,6,7,8</quad4></Surface>'
        f'<SurfacePair name="{pair}"><primary>above</primary><secondary>below</secondary></SurfacePair>'
    )
    return text.replace("</Mesh>", f"{sides}</Mesh>")


def made(folder: Path, inside: str, kind: str = "sliding-elastic") -> Any:
    contact = f'<contact type="{kind}" surface_pair="faces">{inside}</contact>'
    return lower(cube.read(folder, content(contact))).common.contacts[0]


def test_parameters_reach_the_solver(tmp_path: Path) -> None:
    c = made(
        tmp_path,
        "<laugon>AUGLAG</laugon><penalty>7</penalty><two_pass>1</two_pass><gaptol>0.1</gaptol><tolerance>0.3</tolerance>"
        "<search_radius>2</search_radius><tension>1</tension><auto_penalty>1</auto_penalty><maxaug>4</maxaug>",
    )
    assert (c.laugon, c.two_pass, c.gaptol, c.tolerance, c.search_radius) == (True, True, 0.1, 0.3, 2.0)
    assert made(tmp_path, "<smooth_aug>true</smooth_aug>").smooth_aug
    assert (c.tension, c.auto_penalty, c.maxaug, c.minaug) == (True, True, 4, 0)
    assert c.primary.owner["quad4"].tolist() == [[0, 0]]
    assert c.penalty(0.0, None, [0])[0] == 7.0


BIPHASIC = (
    '<material id="1" name="m" type="biphasic"><phi0>0.2</phi0><solid type="neo-Hookean"><E>2</E><v>0.3</v></solid>'
    '<permeability type="perm-const-iso"><perm>1</perm></permeability></material>'
)


def test_friction_of_biphasic_contacts(tmp_path: Path) -> None:
    inside = "<fric_coeff>0.3</fric_coeff><contact_frac>0.2</contact_frac><smooth_fls>1</smooth_fls>"
    contact = f'<contact type="sliding-biphasic" surface_pair="faces">{inside}</contact>'
    text = content(contact).replace(MATERIAL, BIPHASIC).replace('type="solid"', 'type="biphasic"')
    c = lower(cube.read(tmp_path, text)).common.contacts[0]
    assert (c.fric_coeff, c.contact_frac, c.smooth_fls) == (0.3, 0.2, True)


def test_the_contact_potential_has_rules_of_its_own(tmp_path: Path) -> None:
    inside = "<laugon>0</laugon><kc>3</kc><p>2</p><R_in>0.1</R_in><R_out>0.2</R_out><w_tol>0.5</w_tol>"
    c = made(tmp_path, inside, "contact potential")
    assert (c.p, c.R_in, c.R_out, c.w_tol, c.primary.rules) == (2.0, 0.1, 0.2, 0.5, {})
    c = made(tmp_path, inside + "<integration_rule>higher-order</integration_rule>", "contact potential")
    assert c.primary.rules["quad4"] == c.secondary.rules["quad4"] == "G16"


def test_flipped_surfaces_face_the_other_way(tmp_path: Path) -> None:
    plain = made(tmp_path, "").primary.conn["quad4"][0].tolist()
    turned = made(tmp_path, "<flip_primary>1</flip_primary>").primary.conn["quad4"][0].tolist()
    assert turned == [plain[0], plain[3], plain[2], plain[1]]


@pytest.mark.parametrize(
    ("kind", "inside", "said"),
    [
        ("sliding-biphasic-mixed", "", 'contact type="sliding-biphasic-mixed"'),
        ("contact potential", "<check_intersections>1</check_intersections>", "<check_intersections>"),
        ("tied-elastic", "<laugon>LAGMULT</laugon>", 'LAGMULT</laugon> of <contact type="tied-elastic">'),
        ("tied-node-on-facet", "<laugon>LAGMULT</laugon><offset_shells>1</offset_shells>", "LAGMULT"),
        ("sliding-facet-on-facet", "<smooth_aug>1</smooth_aug>", "<smooth_aug>"),
        ("sliding-elastic", "<node_reloc>1</node_reloc>", "<node_reloc>"),
        ("sliding-elastic", "<strange>1</strange>", "<strange>"),
        ("sliding-biphasic", "", "without fluid"),
    ],
)
def test_what_is_lacking_is_refused_by_name(tmp_path: Path, kind: str, inside: str, said: str) -> None:
    contact = f'<contact type="{kind}" surface_pair="faces">{inside}</contact>'
    found = unsupported(cube.read(tmp_path, content(contact)))
    assert len(found) == 1
    assert said in found[0].message
    assert found[0].where is not None and found[0].where.line > 0


TIED = '<contact type="tied-node-on-facet" surface_pair="faces"><laugon>LAGMULT</laugon>{}</contact>'


def test_nodes_tied_by_multipliers_follow_their_facets(tmp_path: Path) -> None:
    found = lower(cube.read(tmp_path, content(TIED.format("")))).common
    assert not found.contacts
    assert [(c.node, c.column) for c in found.constraints] == [(n, i) for n in (4, 5, 6, 7) for i in range(3)]
    for c in found.constraints:
        assert sorted(c.nodes.tolist()) == [0, 1, 2, 3]
        assert max(c.values) == pytest.approx(1.0)
        assert c.offset == pytest.approx(-1.0 if c.column == 2 else 0.0)
    assert not lower(cube.read(tmp_path, content(TIED.format("<max_distance>0.5</max_distance>")))).common.constraints


def test_nodes_tied_by_multipliers_are_not_held_besides(tmp_path: Path) -> None:
    turned = "<primary>below</primary><secondary>above"
    text = content(TIED.format("")).replace("<primary>above</primary><secondary>below", turned)
    found = unsupported(cube.read(tmp_path, text))
    assert len(found) == 1
    assert "at node 1, which is held besides" in found[0].message


def test_an_unknown_pair_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="surface pair"):
        lower(cube.read(tmp_path, content('<contact type="sliding-elastic" surface_pair="faces"/>', "others")))

"""<constraint type="tied-line"> and "slide-line": what is read, what is wrong with them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from febkit.lower import lower, unsupported
from febkit.model import InputError
from febkit.solver.contact.lines import SlideLine, TiedLine
from helpers import cube

MATERIAL = '<material id="1" name="m" type="neo-Hookean"><density>1</density><E>2</E><v>0.3</v></material>'
EDGES = (
    '<Edge name="near"><line2 id="1">1,2</line2></Edge><Edge name="far"><line2 id="1">5,6</line2></Edge>'
    '<Edge name="bent"><line3 id="1">5,6,7</line3></Edge>'
)


def content(kind: str, inside: str, ends: tuple[str, str] = ("near", "far")) -> str:
    sides = f"<primary>{ends[0]}</primary><secondary>{ends[1]}</secondary>"
    more = f'<Constraints><constraint type="{kind}">{inside}{sides}</constraint></Constraints>'
    return cube.text(MATERIAL, more=more).replace("</Mesh>", f"{EDGES}</Mesh>")


def made(folder: Path, kind: str, inside: str) -> Any:
    return lower(cube.read(folder, content(kind, inside))).common.contacts[0]


def test_parameters_reach_the_solver(tmp_path: Path) -> None:
    inside = "<laugon>AUGLAG</laugon><penalty>7</penalty><tolerance>0.3</tolerance><minaug>1</minaug><maxaug>4</maxaug>"
    tie = made(tmp_path, "tied-line", inside + "<max_distance>2</max_distance>")
    assert isinstance(tie, TiedLine)
    assert (tie.laugon, tie.tolerance, tie.minaug, tie.maxaug, tie.max_distance) == (True, 0.3, 1, 4, 2.0)
    assert tie.penalty(0.0, None, [0])[0] == 7.0
    assert (tie.primary.tolist(), tie.secondary.tolist()) == ([[0, 1]], [[4, 5]])
    slide = made(tmp_path, "slide-line", inside + "<gaptol>0.1</gaptol><seg_up>2</seg_up>")
    assert isinstance(slide, SlideLine)
    assert (slide.gaptol, slide.seg_up, slide.laugon) == (0.1, 2, True)


def test_a_line_of_three_nodes_is_refused(tmp_path: Path) -> None:
    found = unsupported(cube.read(tmp_path, content("tied-line", "", ("near", "bent"))))
    assert len(found) == 1
    assert "lines of 3 nodes" in found[0].message
    assert found[0].where is not None and found[0].where.line > 0


def test_an_unknown_edge_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r'there is no edge "farr".*"far"'):
        lower(cube.read(tmp_path, content("tied-line", "", ("near", "farr"))))


def test_a_slide_line_needs_its_penalty(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="lacks <penalty>"):  # FEBio takes whatever stands in memory
        lower(cube.read(tmp_path, content("slide-line", "")))

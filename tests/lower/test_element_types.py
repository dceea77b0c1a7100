"""elem_type: the integration rule that a domain asks for (numbers of one: test_shells_in_febio)."""

from __future__ import annotations

from pathlib import Path

import pytest

from febkit.lower import unsupported
from febkit.model import InputError
from helpers import cube

MATERIAL = '<material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material>'
SHELL = '<ShellDomain name="cube" mat="m" elem_type="{}"><shell_thickness>0.1</shell_thickness></ShellDomain>'


def solid(asked: str) -> str:
    return cube.text(MATERIAL).replace('<SolidDomain name="cube"', f'<SolidDomain elem_type="{asked}" name="cube"')


def shell(asked: str) -> str:
    text = cube.text(MATERIAL).replace('<SolidDomain name="cube" mat="m"/>', SHELL.format(asked))
    return text.replace(
        '<Elements type="hex8" name="cube"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>',
        '<Elements type="quad4" name="cube"><elem id="1">1,2,3,4</elem></Elements>',
    )


@pytest.mark.parametrize(("text", "rule"), [
    (solid("HEX8G6"), "G6"), (solid("HEX8G8"), "G8"), (solid("default"), None), (shell("QUAD4G12"), "G12"),
])  # fmt: skip
def test_the_attribute_names_a_rule(text: str, rule: str | None, tmp_path: Path) -> None:
    assert cube.problem(tmp_path, text).blocks[0].rule == rule


def test_a_rule_of_another_element_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='elem_type "TET10G4" of part "cube": elements of type hex8 have HEX8G8'):
        cube.problem(tmp_path, solid("TET10G4"))


@pytest.mark.parametrize("asked", ["HEX8G1", "HEX8G27"])
def test_other_rules_are_refused(asked: str, tmp_path: Path) -> None:
    (refusal,) = unsupported(cube.read(tmp_path, solid(asked)))
    assert f'elem_type="{asked}"' in refusal.message and refusal.where is not None and refusal.where.line

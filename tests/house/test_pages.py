"""The pages keep true: what CONTRIBUTING names exists, lists of what is solved and commands are current."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import pytest

from house import supported

ROOT = Path(__file__).parents[2]

KINDS = (
    "solids", "permeabilities", "supplies", "diffusivities", "solubilities", "osmotic_coefficients", "solute_supplies",
    "reactions", "reaction_rates", "membrane_reactions", "membrane_rates", "loads",
)  # fmt: skip


def test_files_named_in_contributing_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text()
    named = [p for p in re.findall(r"`([\w./<>-]+(?:\.py|\.toml|\.feb|/))`", text) if "<" not in p]
    assert len(named) > 10
    homes = (ROOT, ROOT / "solver" / "solids", ROOT / "templates" / "tissue")
    assert [p for p in named if not any((home / p).exists() for home in homes)] == []


@pytest.mark.parametrize("folder", KINDS)
def test_every_type_is_registered_at_the_foot_of_its_file(folder: str) -> None:
    """'Write the file, end it with register, enter it in the table' is all it takes."""
    from febkit.solver.solids.registry import tables

    if folder == "solids":
        entries = {kind: at.split(":")[0] for kind, at in tables()["solid"].items()}
    else:
        entries = dict(import_module(f"febkit.solver.{folder}").TYPES)
    assert entries
    for kind, name in entries.items():
        source = (ROOT / "solver" / folder / f"{name}.py").read_text()
        assert re.search(r"register\(", source.rstrip().rsplit("\n\n", 1)[-1]), f"{kind}: {name}.py"


def test_a_page_lists_what_the_solver_knows() -> None:
    text = (ROOT / "docs" / "features.md").read_text()
    assert supported.renewed(text) == text, "run: python tests/house/supported.py --write"


def test_what_is_not_solved_has_a_reason_and_little_is_not() -> None:
    """Of FEBio's types, as the page lists them: all plot variables and log items, nine in ten of the others."""
    text = (ROOT / "docs" / "features.md").read_text()
    kinds = re.findall(r"^### (.+): (\d+) of (\d+)\n\nSolved: .*\n\nNot: (.*)$", text, re.M)
    assert len(kinds) > 40
    assert all(a == b for kind, a, b, _ in kinds if kind in ("plot variable", "log item"))
    others = [(int(a), int(b)) for kind, a, b, _ in kinds if kind not in ("plot variable", "log item")]
    assert sum(a for a, _ in others) >= 0.9 * sum(b for _, b in others)
    for _, a, b, lacks in kinds:
        assert lacks.count("(") == int(b) - int(a), lacks


def test_the_readme_lists_every_verb() -> None:
    from febkit.cli.main import VERBS

    text = (ROOT / "README.md").read_text()
    assert [v for v in VERBS if f"| `febkit {v}`" not in text] == []


def test_files_the_readme_names_exist() -> None:
    text = (ROOT / "README.md").read_text()
    named = re.findall(r"(?:examples|docs)/[\w./-]+\.\w+", text)
    assert named and [p for p in named if not (ROOT / p).exists() and not p.endswith((".xplt", ".log"))] == []

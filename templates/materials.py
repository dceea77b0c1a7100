"""Materials as tables: ``{type = "Holmes-Mow", E = 0.5, v = 0.2, beta = 1.5}``, any that FEBio's file can say.

A key is a tag, its value a number, a text, a list of numbers (commas between), a table (a tag with tags in it) or a
list of tables (the tag repeated). ``type`` and keys that begin with @ are attributes, ``text`` is the tag's own text:
``perm = {"@lc" = 1, text = 0.002}`` is ``<perm lc="1">0.002</perm>``. Texts may hold ``${...}`` of the template's
parameters. A table of ``file`` and ``material`` takes the material of that name in a .feb file.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from febkit.model import Component, InputError, Model

MIXTURES = ("biphasic", "biphasic-solute", "triphasic", "multiphasic")
# what a biphasic material holds beside its solid
OF_MIXTURE = ("phi0", "fluid_density", "permeability", "solvent_supply", "momentum_supply")


def mixture(table: Mapping[str, Any], phi0: float, k: float) -> dict[str, Any]:
    """A biphasic material from a table of a solid, or a table of a mixture as it is.

    The solid's table may hold :data:`OF_MIXTURE` as well; without them the solid volume fraction is ``phi0`` and the
    permeability constant, ``k``.
    """
    if table.get("file") is not None:
        return from_file(str(table["file"]), str(table.get("material", "")))
    if not isinstance(table.get("type"), str):
        raise InputError('a material needs its type, such as type = "Holmes-Mow" (febkit features lists them), or file '
                         f"and material; there is {', '.join(table) or 'nothing'}")
    if table["type"] in MIXTURES:
        return dict(table)
    of_mixture = {"phi0": phi0, "fluid_density": 0, "permeability": {"type": "perm-const-iso", "perm": k}}
    of_mixture |= {tag: table[tag] for tag in OF_MIXTURE if tag in table}
    return {"type": "biphasic", **of_mixture, "solid": {t: v for t, v in table.items() if t not in OF_MIXTURE}}


def from_file(path: str, name: str) -> dict[str, Any]:
    """The material of a name in a .feb file, as a table. Raises InputError where it is missing or goes by curves."""
    from febkit.feb import read

    try:
        model = read(path)
    except InputError as e:
        raise InputError(f"{path}: {e.message}") from None
    found = [m for m in model.materials if m.name == name]
    if not found:
        names = ", ".join(str(m.name) for m in model.materials) or "none"
        raise InputError(f"{path} has no material '{name}'; it has {names}")
    table = _table(found[0])
    if not isinstance(table, dict):
        raise InputError(f"material '{name}' of {path} is empty")
    return table


def _table(c: Component) -> Any:
    if c.lc is not None or c.type == "map":
        raise InputError(f"<{c.tag}> goes by a curve or a map, which this model would lack; give a number", c.where)
    attributes = ({"type": c.type} if c.type else {}) | {
        f"@{k}": v for k, v in c.attrs.items() if k not in ("id", "name", "type")}
    if not c.children and not attributes:
        return c.text
    table: dict[str, Any] = attributes | ({"text": c.text} if c.text.strip() else {})
    for child in c.children:
        table.setdefault(child.tag, []).append(_table(child))
    return table


def check(model: Model) -> None:
    """Refuse materials that FEBio does not have, and parameters that they lack or that lie outside of their range."""
    from febkit.feb import check_features, check_ranges

    for m in model.materials:
        for found in (*check_features.component(m, "material", False), *check_ranges.component(model, m)):
            if found.severity == "error":
                raise InputError(f"material '{m.name}': {found.message}")

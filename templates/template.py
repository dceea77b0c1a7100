"""A template: a folder with ``template.toml`` (parameters, mesh) and a model file (a .feb skeleton)."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from febkit.model import InputError, Model, Where

from .expression import evaluate
from .generators import GENERATORS
from .materials import check
from .parameters import Parameter, chosen, declared
from .parts import Generated
from .skeleton import instantiate

HERE = Path(__file__).resolve().parent
BUILT_IN = ("tissue", "cell", "embedded", "cartilage", "chondron")


@dataclass(frozen=True, slots=True)
class Template:
    """What the folder says. ``model`` is the skeleton's path, ``mesh`` the name of a generator, ``names`` expressions
    of the parameters that the skeleton uses beside them, ``brought`` the values that a choice brings along."""

    name: str
    title: str
    mesh: str
    model: Path
    parameters: Mapping[str, Parameter]
    sizes: Mapping[str, Mapping[str, Any]]
    names: Mapping[str, str] = field(default_factory=dict)
    brought: Mapping[str, Mapping[str, Mapping[str, Any]]] = field(default_factory=dict)

    def values(self, given: Sequence[tuple[Mapping[str, Any], Where]] = ()) -> dict[str, Any]:
        """All parameters with the values given; later tables win."""
        return chosen(self.parameters, self.sizes, given, self.brought)

    def build(self, values: Mapping[str, Any]) -> tuple[Model, Generated]:
        """The model and its mesh."""
        made = GENERATORS[self.mesh](dict(values))
        known = dict(values) | dict(made.facts)
        for name, text in self.names.items():
            known[name] = evaluate(text, known, Where(f"[names] of the template {self.name}"))
        model = instantiate(self.model, known, made.mesh)
        check(model)
        return replace(model, mesh_data=(*model.mesh_data, *made.data)), made


def load(name: str, folder: Path | None = None) -> Template:
    """A built-in template, or the one in a user's folder (or in its subfolder ``name``)."""
    home = HERE / name
    if folder is not None:
        home = folder if (folder / "template.toml").is_file() else folder / name
        if not (home / "template.toml").is_file():
            raise InputError(f"no template.toml in {folder} nor in {folder / name}")
    elif name not in BUILT_IN:
        raise InputError(f"no template '{name}'; there are {', '.join(BUILT_IN)}; "
                         "--template FOLDER uses one of your own")
    return _read(home / "template.toml", depth=0)


def _read(path: Path, depth: int) -> Template:
    where = Where(str(path))
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as e:
        raise InputError(f"cannot open the template: {e.strerror}", where) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
        raise InputError(f"not well-formed TOML: {e}", where) from None
    unknown = set(table) - {"title", "base", "mesh", "model", "parameters", "sizes", "names", "with"}
    if unknown:
        raise InputError(f"unknown entry '{sorted(unknown)[0]}' in a template", where)
    base = _base(table, path, depth)
    merged = _merged(base.parameters if base else {}, table.get("parameters", {}), where)
    mesh = table.get("mesh", base.mesh if base else "")
    if mesh not in GENERATORS:
        raise InputError(f"mesh = '{mesh}' is no mesh generator; there are {', '.join(GENERATORS)}", where)
    model = path.parent / table.get("model", "model.feb")
    if not model.is_file() and base and "model" not in table:
        model = base.model
    sizes = dict(base.sizes if base else {}) | table.get("sizes", {})
    names = dict(base.names if base else {}) | {k: str(v) for k, v in table.get("names", {}).items()}
    brought = dict(base.brought if base else {}) | table.get("with", {})
    unknown = set(brought) - set(merged)
    if unknown:
        raise InputError(f"[with.{sorted(unknown)[0]}] names no parameter", where)
    return Template(path.parent.name, str(table.get("title", "")), mesh, model, merged, sizes, names, brought)


def _base(table: Mapping[str, Any], path: Path, depth: int) -> Template | None:
    """The template that ``base`` names: a built-in one or a folder beside this file."""
    name = table.get("base")
    if name is None:
        return None
    if depth > 8:
        raise InputError("templates name each other as base in a circle", Where(str(path)))
    beside = path.parent / str(name) / "template.toml"
    home = beside if beside.is_file() else HERE / str(name) / "template.toml"
    if not home.is_file():
        raise InputError(f"base = '{name}' is neither a folder here nor one of {', '.join(BUILT_IN)}",
                         Where(str(path)))
    return _read(home, depth + 1)


def _merged(base: Mapping[str, Parameter], tables: Mapping[str, Any], where: Where) -> dict[str, Parameter]:
    """Parameters of the base, changed and added to. A changed one may give its default alone."""
    merged = dict(base)
    for name, table in tables.items():
        if name == "size":
            raise InputError("'size' is reserved: it names a table under [sizes]", where)
        if not isinstance(table, dict):
            table = {"default": table}
        old = base.get(name)
        if old is not None:
            full: dict[str, Any] = {"default": old.default, "doc": old.doc, "unit": old.unit,
                                    "kind": old.kind, "choices": list(old.choices), "length": old.length,
                                    "rising": old.rising} | dict(old.limits)
            table = full | table
        merged[name] = declared(name, table, where)
    return merged


def parameters_file(path: Path) -> tuple[dict[str, Any], Where]:
    """Values from a TOML file of ``name = value`` lines."""
    where = Where(str(path))
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as e:
        raise InputError(f"cannot open the parameters: {e.strerror}", where) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
        raise InputError(f"not well-formed TOML: {e}", where) from None
    return table, where

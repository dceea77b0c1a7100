"""The models of a study as its file gives them: the tissue by case, the cells by zone and variant, the control."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from febkit.model import InputError, Where
from febkit.model.values import near

from .entries import Entries

if TYPE_CHECKING:
    from febkit.templates.template import Template

CASES = ("A", "B", "C", "D")
OWN = "own"  # the one case of a tissue that is no published one's
Table = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Case:
    """A load: what the tissue and the control have in it beside, or instead of, what their tables say."""

    name: str
    tissue: Table = field(default_factory=dict)
    embedded: Table = field(default_factory=dict)


def given(top: Entries, name: str) -> dict[str, Any]:
    """A model's parameters; the template checks them."""
    table = dict(top.table(name).given)
    for key in ("file", "results", "template"):
        if key in table:
            table[key] = top.table(name).text(key, "")
    return table


def cases(top: Entries, tissue: Table) -> tuple[Case, ...]:
    """``cases``: a list of the published ones, or tables of one's own, [cases.NAME], each with parameters of the tissue
    and the control; those of one of the two in [cases.NAME.tissue] and [cases.NAME.embedded]."""
    said = top.given.get("cases")
    if isinstance(said, Mapping):
        if not said:
            raise top.refuse("cases", "a list of cases or tables [cases.NAME]")
        return tuple(_own(Entries(said, top.where, "cases").table(str(name)), str(name)) for name in said)
    if said is None and ("file" in tissue or "case" not in template_of(tissue, "tissue").parameters):
        return (Case(OWN),)
    names = top.listed("cases", list(CASES))
    for c in names:
        if c not in CASES:
            raise InputError(
                f"case {c!r} is none of {', '.join(CASES)}; [cases.NAME] makes one of your own", top.where
            )
    if len(set(names)) < len(names):
        raise InputError("a case is given twice", top.where)
    return tuple(Case(c, {"case": c}, {"case": c}) for c in names)


def _own(e: Entries, name: str) -> Case:
    both = {k: v for k, v in e.given.items() if k not in ("tissue", "embedded")}
    if not name.strip():
        raise InputError("a case needs a name", e.where)
    return Case(name, both | given(e, "tissue"), both | given(e, "embedded"))


def tissues(base: Table, cases: tuple[Case, ...], variant: Variant, home: Path, where: Where) -> dict[str, Table]:
    """The tissue of each case: its table with what the case and the variant change, checked."""
    out: dict[str, Table] = {}
    for c in cases:
        own = located(c.tissue, f"cases.{c.name}.tissue", home, where)
        own |= located(variant.tissue, "variants.tissue", home, where)
        if "file" in base and "file" not in own and set(own) - {"case", "results"}:
            raise InputError(
                f"[tissue] is a file, which takes no parameters: case {c.name}"
                f"{' or a variant' if variant.tissue else ''} can only name another file, "
                f"not {', '.join(own)}",
                where,
            )
        table = dict(own) if "file" in own else {**base, **own}
        if "file" not in table:
            table = with_rows(table, home, where)
            others = [f"cases.{c.name}"] if set(c.tissue) - {"case"} else []
            check(table, "tissue", where, *others, *(["variants.tissue"] if variant.tissue else []))
        out[c.name] = table
    return out


def with_rows(tissue: Table, home: Path, where: Where) -> dict[str, Any]:
    """Profiles over depth as the rows of their CSV files, relative to the study: a step is known by what it is made of,
    wherever it runs."""
    from febkit.templates.profile import anchored, profile

    out, known = dict(tissue), template_of(tissue, "tissue").parameters
    for name, value in tissue.items():
        if name in known and known[name].kind == "field":
            p = profile(name, anchored(value, Where(str(home / "study"))), where)
            out[name] = p.plain() if p.file else value
    return out


def located(t: Table, name: str, base: Path, where: Where) -> dict[str, Any]:
    """A model's parameters with paths of its own files relative to the study."""
    t = dict(t)
    for k in ("file", "results", "template"):
        if k in t and not (k == "template" and _built_in(t[k]) and not (base / t[k]).exists()):
            p = (base / t[k]).resolve()
            if not p.exists():
                raise InputError(_missing(k, name, t[k], p), where)
            if p.is_dir() != (k == "template"):
                raise InputError(
                    f"{k} of [{name}] must be a {'folder' if k == 'template' else 'file'}: {p}", where
                )
            t[k] = str(p)
    return t


def _missing(key: str, name: str, said: str, path: Path) -> str:
    if key != "template":
        return f"{key} of [{name}]: {path} does not exist"
    from febkit.templates.template import BUILT_IN

    hint = near(said, BUILT_IN) or f"; there are {', '.join(BUILT_IN)}"
    return f"template of [{name}]: {said!r} is neither one of febkit's nor a folder here ({path}){hint}"


def check(t: Table, name: str, where: Where, *others: str) -> None:
    """Raises InputError for parameters that the template does not have, or not so; ``others`` are tables that the model
    has them from beside its own."""
    said = " with ".join(f"[{n}]" for n in (name, *others))
    values_of(template_of(t, name), t, Where(f"{where}: {said}"))


def _built_in(name: str) -> bool:
    from febkit.templates.template import BUILT_IN

    return name in BUILT_IN


def template_of(t: Table, name: str) -> Template:
    """The template of a table: the one that it names, built in or a folder, or the study's own ``name``."""
    from febkit.templates.template import load

    said = t.get("template")
    if said is None or _built_in(said):
        return load(said or name)
    return load(name, Path(said))


def values_of(template: Template, t: Table, where: Where) -> dict[str, Any]:
    """All its parameters, as the table has them."""
    own = {k: v for k, v in t.items() if k not in ("file", "results", "template")}
    return template.values([(own, where)])


def central(t: Table) -> bool:
    """Is it the study's own cube, with (0, 0, 0) in its middle?"""
    return not {"file", "results", "template", "mesh_file"} & set(t)


def control(cell: Table, own: Table) -> dict[str, Any]:
    """The control is made of the cell model's own parameters, but not of its files."""
    return {k: v for k, v in cell.items() if k not in ("file", "template", "drive")} | dict(own)


# ---- zones ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Zone:
    """A range of normalised depth, and what its cells have instead of what [cell] says."""

    name: str
    top: float
    bottom: float
    cell: Table = field(default_factory=dict)


def zones(top: Entries, home: Path) -> tuple[Zone, ...]:
    """[zones.NAME] with ``depth`` = [from, to] and parameters of [cell]. Raises InputError for gaps and overlaps."""
    from .points import numbers

    t = top.table("zones")
    out = []
    for name in t.given:
        e = Entries(t.given, top.where, "zones").table(str(name))
        e = Entries(e.given, e.where, f"zones.{name}")
        span = numbers(e.given.get("depth"))
        if span is None or len(span) != 2 or not 0 <= span[0] < span[1] <= 1:
            raise InputError(
                f"[zones.{name}] needs depth = [from, to], 0 at the tissue's top and 1 at its bottom, not "
                f"{e.given.get('depth')!r}",
                top.where,
            )
        if "seed" in e.given:
            raise InputError(
                f"[zones.{name}] has a seed: seeds are those of [cell], for all zones", top.where
            )
        cell = {k: v for k, v in e.given.items() if k != "depth"}
        for key in ("file", "template"):
            if key in cell:
                e.text(key, "")
        out.append(Zone(str(name), span[0], span[1], located(cell, f"zones.{name}", home, top.where)))
    out.sort(key=lambda z: z.top)
    for a, b in zip(out, out[1:]):
        if b.top < a.bottom - 1e-12:
            raise InputError(
                f"zones {a.name} and {b.name} overlap from depth {b.top:g} to {min(a.bottom, b.bottom):g}",
                top.where,
            )
        if b.top > a.bottom + 1e-12:
            raise InputError(
                f"there is a gap between zones {a.name} and {b.name}, from depth {a.bottom:g} to {b.top:g}",
                top.where,
            )
    return tuple(out)


def zone_at(found: tuple[Zone, ...], depth: float, what: str, where: Where) -> int:
    """Index of the zone at a depth; the deeper one where two meet."""
    for k in reversed(range(len(found))):
        if found[k].top - 1e-9 <= depth <= found[k].bottom + 1e-9:
            return k
    raise InputError(
        f"{what} at depth {depth:.4g} lies in no zone; they reach from {found[0].top:g} to {found[-1].bottom:g}",
        where,
    )


# ---- variants -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Variant:
    """One of several models that a study compares, by what it changes of [cell], of the control and of the tissue."""

    name: str
    cell: Table = field(default_factory=dict)
    embedded: Table = field(default_factory=dict)
    tissue: Table = field(default_factory=dict)


def variants(top: Entries) -> tuple[Variant, ...]:
    """[variants]: lists of parameters of [cell], all as long, one model for each entry; [variants.embedded] and
    [variants.tissue] likewise of the control and the tissue; ``names`` says what they are called, else the first list
    does."""
    t = top.table("variants")
    if not t.given:
        return (Variant(""),)
    others = {name: t.table(name).given for name in ("embedded", "tissue")}
    cell = {k: v for k, v in t.given.items() if k not in ("names", *others)}
    lists = {**cell, **{f"{name}.{k}": v for name, own in others.items() for k, v in own.items()}}
    if not cell and not others["tissue"]:
        raise InputError(
            "[variants] needs lists of parameters of [cell], as edge = [0.05, 0.1], or of [tissue] in "
            "[variants.tissue]",
            t.where,
        )
    first, given = next((k, v) for k, v in lists.items() if not k.startswith("embedded."))
    if not isinstance(given, list) or not given:
        raise InputError(f"{first} of [variants] must be a list with an entry for each variant, not {given!r}", t.where)
    length = len(given)
    for k, v in lists.items():
        if k.rpartition(".")[2] == "seed":
            raise InputError(f"{k} of [variants]: seeds are those of [cell], for all variants", t.where)
        if not isinstance(v, list) or not v or len(v) != length:
            raise InputError(
                f"{k} of [variants] must be a list as long as {first}, one entry for each variant, not "
                f"{v!r}",
                t.where,
            )
    names = [str(n) for n in t.listed("names", [f"{first.replace('.', ' ')} {_short(v)}" for v in given])]
    if len(names) != length or len(set(names)) < length:
        raise InputError(f"names of [variants] must be {length} different ones", t.where)
    return tuple(
        Variant(n, *({p: v[k] for p, v in own.items()} for own in (cell, *others.values())))
        for k, n in enumerate(names)
    )


def _short(v: Any) -> str:
    return f"{v:g}" if isinstance(v, int | float) and not isinstance(v, bool) else str(v)

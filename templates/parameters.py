"""Parameters of a template: their defaults, units and bounds, and the values a user gives."""

from __future__ import annotations

import operator
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from febkit.model import InputError, Where
from febkit.model.values import near

from .profile import Profile, anchored, profile

_FIELDS = {"default", "doc", "unit", "min", "max", "above", "below", "choices", "kind", "length", "rising"}
_KINDS: dict[str, tuple[type, ...]] = {
    "integer": (int,), "number": (int, float), "text": (str,), "switch": (bool,), "list": (list,),
    "numbers": (int, float, list), "table": (dict,), "text or numbers": (str, list),
    "field": (int, float, list, str, dict, Profile),
}
_Limit = tuple[str, str, Callable[[float, float], bool]]
_LIMITS: tuple[_Limit, ...] = (
    ("min", "at least", operator.ge), ("max", "at most", operator.le),
    ("above", "greater than", operator.gt), ("below", "less than", operator.lt),
)


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter as ``[parameters.name]`` of a template file says it.

    ``kind``: integer, number, text, switch, list, numbers (one, or lists of them), table, field (a profile over
    depth: :mod:`.profile`); told from the default where it is not given. Bounds ``min max above below`` hold for every
    number in a value; ``length`` and ``rising`` are asked of a list.
    """

    name: str
    default: Any
    doc: str
    unit: str = ""
    kind: str = ""
    choices: tuple[Any, ...] = ()
    limits: Mapping[str, float] = field(default_factory=dict)
    length: int = 0
    rising: bool = False

    def checked(self, value: Any, where: Where | None = None) -> Any:
        """The value, or an InputError that says what is allowed."""
        if self.choices and value not in self.choices:
            names = ", ".join(map(str, self.choices))
            raise InputError(f"{self.name} must be one of {names}, not {value}", where)
        if self.kind == "field":
            return self._field(value, where)
        allowed = _KINDS[self.kind]
        if (isinstance(value, bool) and self.kind != "switch") or not isinstance(value, allowed):
            if self.kind == "integer" and isinstance(value, float) and value.is_integer():
                value = int(value)
            else:
                unit = f" ({self.unit})" if self.unit else ""
                raise InputError(f"{self.name} must be of kind {self.kind}{unit}, not {value!r}: {self.doc}",
                                 where)
        for number in _numbers(value):
            self._within(number, where)
        self._check_list(value, where)
        return value

    def _within(self, number: float, where: Where | None, at: str = "") -> None:
        for key, words, holds in _LIMITS:
            bound = self.limits.get(key)
            if bound is not None and not holds(number, bound):
                raise InputError(f"{self.name} must be {words} {bound:g} {self.unit}".rstrip()
                                 + f", not {number:g}{at}", where)

    def _field(self, value: Any, where: Where | None) -> Profile:
        """The profile, every value of it within bounds."""
        p = profile(self.name, anchored(value, where or Where()), where)
        for depth, number in p.samples():
            between = p.rule in ("cubic", "monotone") and depth not in p.depths
            at = f" (between rows, at depth {depth:.3g}: take rule = \"monotone\" or more rows)" if between else \
                f" (at depth {depth:g})" if p.depths else ""
            self._within(number, Where(p.file) if p.file else where, at)
        return p

    def _check_list(self, value: Any, where: Where | None) -> None:
        if self.length and len(value) != self.length:
            raise InputError(f"{self.name} must have {self.length} entries, not {len(value)}: {self.doc}",
                             where)
        if self.rising and (len(value) < 2 or any(b <= a for a, b in pairwise(value))):
            raise InputError(f"{self.name} must be two or more rising numbers", where)


def _numbers(value: Any) -> list[float]:
    if isinstance(value, list):
        return [x for v in value for x in _numbers(v)]
    return [value] if isinstance(value, int | float) and not isinstance(value, bool) else []


def declared(name: str, table: Mapping[str, Any], where: Where) -> Parameter:
    """A parameter from its table in the template file."""
    unknown = set(table) - _FIELDS
    if unknown:
        raise InputError(f"[parameters.{name}] has no field '{sorted(unknown)[0]}'; "
                         f"known: {', '.join(sorted(_FIELDS))}", where)
    if "default" not in table or not table.get("doc"):
        raise InputError(f"[parameters.{name}] needs a default and a doc", where)
    default = table["default"]
    kind = table.get("kind") or _told(default)
    if kind not in _KINDS:
        raise InputError(f"[parameters.{name}] has the unknown kind '{kind}'; known: {', '.join(_KINDS)}",
                         where)
    limits = {k: float(table[k]) for k, _, _ in _LIMITS if k in table}
    if kind == "field":
        default = anchored(default, where)
    p = Parameter(name, default, " ".join(str(table["doc"]).split()), str(table.get("unit", "")), kind,
                  tuple(table.get("choices", ())), limits, int(table.get("length", 0)),
                  bool(table.get("rising", False)))
    if kind == "field":
        p._field(default, None)
    else:
        p.checked(default, where)
    return p


def _told(default: Any) -> str:
    for kind, types in (("switch", bool), ("integer", int), ("number", float), ("text", str), ("list", list),
                        ("table", dict)):
        if isinstance(default, types):
            return kind
    return ""


def from_text(text: str) -> Any:
    """The value of ``--set name=text``: as TOML reads it, a bare word as text, ``a,b,c`` as a list.

    >>> from_text("11"), from_text("A"), from_text("3,2,2"), from_text("[0, 0.1]")
    (11, 'A', [3, 2, 2], [0, 0.1])
    """
    for attempt in (text, f"[{text}]" if "," in text else text):
        try:
            return tomllib.loads(f"v = {attempt}")["v"]
        except tomllib.TOMLDecodeError:
            continue
    return text


def chosen(parameters: Mapping[str, Parameter], sizes: Mapping[str, Mapping[str, Any]],
           given: Sequence[tuple[Mapping[str, Any], Where]],
           brought: Mapping[str, Mapping[str, Mapping[str, Any]]] | None = None) -> dict[str, Any]:  # fmt: skip
    """Values of all parameters: the defaults, those that a choice brings along (``brought``: parameter -> value ->
    values of others), those of the named size, those given, in order."""
    sources: list[tuple[Mapping[str, Any], Where]] = list(given)
    size = next((v["size"] for v, _ in reversed(sources) if "size" in v), None)
    if size is not None:
        if not isinstance(size, str) or size not in sizes:
            at = next(w for v, w in reversed(sources) if "size" in v)
            raise InputError(f"size must be one of {', '.join(sizes) or 'none'}, not {size}", at)
        sources.insert(0, (sizes[size], Where()))
    for name, cases in (brought or {}).items():
        value = next((v[name] for v, _ in reversed(sources) if name in v), parameters[name].default)
        if value in cases:
            sources.insert(0, (cases[value], Where()))
    values = {name: profile(name, p.default) if p.kind == "field" else p.default for name, p in parameters.items()}
    for table, where in sources:
        for name, value in table.items():
            if name == "size":
                continue
            if name not in parameters:
                raise InputError(f"'{name}' is no parameter of this template"
                                 + (near(name, parameters) or f"; known: {', '.join(parameters)}, size"), where)
            values[name] = parameters[name].checked(value, where)
    return values

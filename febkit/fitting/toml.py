"""What a fit.toml says, checked before anything runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from febkit.model import InputError, Where
from febkit.study.entries import Entries, entry, load

from .experiment import Experiment
from .parameters import Parameter, Spec
from .run import METHODS

EXPERIMENT = ("model", "data", "observe", "against", "sigma", "meet", "settings")
TOP = ("parameters", "experiment", "method", "tolerance", "step", "most", "exact", "seed", *EXPERIMENT)
NUMBERS = ("low", "start", "high", "log", "paths", "scale")


@dataclass(frozen=True, slots=True)
class Asked:
    """A file's experiments, shared parameters, and options of :func:`febkit.fit`."""

    experiments: list[Experiment]
    parameters: dict[Any, Spec]
    options: dict[str, Any]


def read(path: str | Path) -> Asked:
    """Read a fit.toml; files that it names lie beside it. Raises InputError naming the file and the entry."""
    path = Path(path)
    given, where = load(path, "the fit")
    top = Entries(given, where, what="a fit")
    top.only(TOP)
    several = given.get("experiment", [])
    if not isinstance(several, list) or not all(isinstance(t, Mapping) for t in several):
        raise InputError("experiments are tables, [[experiment]]", where)
    shared = {k: v for k, v in given.items() if k in EXPERIMENT}
    tables = [Entries(shared | dict(t), where, "[experiment]") for t in several or [{}]]
    options: dict[str, Any] = {"method": top.choice("method", METHODS[0], METHODS), "seed": top.whole("seed", 0, 0),
                               "most": top.whole("most", 0, 0)}  # fmt: skip
    options |= {k: top.positive(k, 1.0) for k in ("tolerance", "step") if k in given}
    if "exact" in given:
        options["exact"] = top.flag("exact", True)
    return Asked([_experiment(t, path.parent) for t in tables], _parameters(top.table("parameters")), options)


def placed(e: InputError, path: str | Path, names: Iterable[Any]) -> InputError:
    """An error of what the file asks for, with the line of the entry that it tells of, as far as that is known."""
    if e.where is not None:
        return e
    told = [n for name in names for n in ([name] if isinstance(name, str) else name) if n in e.message]
    if told:
        return InputError(e.message, entry(Where(str(path)), max(told, key=len), "parameters"))
    return InputError(e.message, _observed(path, e.message) if ": observe" in e.message else Where(str(path)))


def _observed(path: str | Path, message: str) -> Where:
    """Where observe = ... stands, of several the one whose words the message has."""
    found = []
    for number, line in enumerate(Path(path).read_text(encoding="utf-8").splitlines(), 1):
        head, equals, words = line.partition("=")
        if equals and head.strip() == "observe":
            found.append((not any(w in message for w in words.split('"')[1::2]), number))
    return Where(str(path), min(found)[1]) if found else Where(str(path))


def _experiment(t: Entries, base: Path) -> Experiment:
    t.only((*EXPERIMENT, "name", "parameters"))
    for key in ("model", "data", "observe"):
        if key not in t.given:
            raise InputError(f"{key} is missing: a fit needs model, data and observe", t.where)
    observe = t.given["observe"]
    words = list(observe.values()) if isinstance(observe, Mapping) else t.listed("observe", [])
    if not words or not all(isinstance(w, str) for w in words):
        raise t.refuse("observe", 'words, such as "reaction top z", a list or a table of them')
    settings = t.table("settings").given
    for k, v in settings.items():
        if isinstance(v, bool) or not isinstance(v, int | float):
            raise InputError(f"settings: {k} must be a number, not {v!r}", t.at(k))
    return Experiment(
        base / t.text("model", ""), base / t.text("data", ""), observe, t.given.get("against"), t.given.get("sigma"),
        _parameters(t.table("parameters")), settings, t.text("name", "experiment") if "name" in t.given else "",
        t.flag("meet", True) if "meet" in t.given else None,
    )  # fmt: skip


def _parameters(t: Entries) -> dict[Any, Spec]:
    return {name: _parameter(t, name) for name in t.given}


def _parameter(t: Entries, name: str) -> Spec:
    """[low, start, high], a table of them, or a formula of other parameters."""
    v = t.given[name]
    if isinstance(v, str):
        return v
    if isinstance(v, list):
        v = dict(zip(("low", "start", "high"), v)) if len(v) == 3 else {}
    if not isinstance(v, Mapping) or not {"low", "start", "high"} <= v.keys():
        raise t.refuse(name, "[low, start, high], a table with low, start and high, or a formula")
    own = Entries(v, t.at(name), name)
    own.only(NUMBERS)
    for key in ("low", "start", "high", "scale"):
        if key in v and (isinstance(v[key], bool) or not isinstance(v[key], int | float)):
            raise own.refuse(key, "a number")
    paths = tuple(map(str, own.listed("paths", []))) if "paths" in v else ()
    return Parameter(float(v["low"]), float(v["start"]), float(v["high"]), own.flag("log", False), paths,
                     float(v.get("scale", 0.0)))  # fmt: skip

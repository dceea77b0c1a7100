"""FEBio's optimisation files: <febio_optimize>, as FEBio 4.11 reads them (FEBioOpt, FEOptimizeInput)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from febkit.feb.document import Tag, parse
from febkit.model import InputError, Where

from .parameters import Parameter
from .probes import Probe, datum, probe

Floats = NDArray[np.float64]
VERSIONS = ("2.0", "2.5", "3.0", "4.0")
LEVELS = ("LOG_DEFAULT", "LOG_NEVER", "LOG_FILE_ONLY", "LOG_SCREEN_ONLY", "LOG_FILE_AND_SCREEN")
PRINT = {"PRINT_ITERATIONS": False, "PRINT_VERBOSE": True, "0": False, "1": True}
_LEVMAR = {"obj_tol": 1e-3, "f_diff_scale": 1e-3, "max_iter": 100.0}
METHODS: dict[str, dict[str, float]] = {
    "levmar": {**_LEVMAR, "print_cov": 0.0},
    "constrained levmar": {**_LEVMAR, "tau": 1e-3, "scale_parameters": 0.0},
    "powell": {},
    "scan": {},
}
MOST = 64  # parameters


@dataclass(frozen=True, slots=True)
class Objective:
    """What a run is compared with: data ``y`` (n,) at ``x``, and what is followed for it.

    ``evaluate(rows)``: (n,) values of the run from the rows of its probes (state, probe); ``name`` and ``axis`` say
    what y and x are.
    """

    probes: tuple[Probe, ...]
    x: Floats
    y: Floats
    evaluate: Callable[[Floats], Floats]
    name: str
    axis: str


@dataclass(frozen=True, slots=True)
class Optimise:
    """An optimisation file. ``lines``: where each parameter is named; ``A``, ``b``: A values = b."""

    where: Where
    method: str
    options: dict[str, float]
    verbose: bool
    parameters: tuple[Parameter, ...]
    lines: tuple[Where, ...]
    A: Floats
    b: Floats
    objective: Objective
    remarks: tuple[str, ...] = field(default=())


def read(path: str | PathLike[str]) -> Optimise:
    """The optimisation file of a path. Raises InputError with the line where it is none that FEBio would take."""
    file = Path(path)
    try:
        root = parse(file.read_bytes(), str(file)).root
    except OSError as e:
        raise InputError(f"cannot open the file: {e.strerror}", Where(str(file))) from None
    if root.name != "febio_optimize":
        raise InputError(f"this is no optimisation file: its root is <{root.name}>, not <febio_optimize>", root.where)
    version = root.need("version")
    if version not in VERSIONS:
        raise InputError(f"version {version!r} of <febio_optimize> is none of {', '.join(VERSIONS)}", root.where)
    parts = {t.name: t for t in _only(root, "Task", "Options", "Parameters", "Constraints", "Objective")}
    for name in ("Parameters", "Objective"):
        if name not in parts:
            raise InputError(f"<febio_optimize> has no <{name}>", root.where)
    if "Task" in parts and parts["Task"].text.strip() != "solve":
        said = parts["Task"].text.strip()
        why = f"<Task>{said}</Task>: febkit has one task, solve" if said else "the task is a text, <Task>solve</Task>"
        raise InputError(why, parts["Task"].where)
    method, options, verbose = _options(parts.get("Options"))
    parameters = _parameters(parts["Parameters"])
    A, b = _constraints(parts.get("Constraints"), len(parameters))
    remarks = [] if version == "2.0" else [f"FEBio takes version 2.0 of <febio_optimize> alone, not {version}"]
    if len(b) and method in ("powell", "scan"):
        remarks.append(f"<Constraints> are not met by {method}, in FEBio neither: take constrained levmar")
    lines = tuple(t.where for t in parts["Parameters"])
    objective = OBJECTIVES[_choice(parts["Objective"], OBJECTIVES)](parts["Objective"], file.parent)
    if not len(objective.y):
        raise InputError("<Objective> has no data", parts["Objective"].where)
    return Optimise(root.where, method, options, verbose, parameters, lines, A, b, objective, tuple(remarks))


# ---- reading tags ---------------------------------------------------------------------------------------
def _only(tag: Tag, *known: str) -> Iterator[Tag]:
    for t in tag:
        if t.name not in known:
            raise InputError(f"<{t.name}> is not known in <{tag.name}>; it may have {', '.join(known)}", t.where)
        yield t


def _choice(tag: Tag, known: object, attr: str = "type") -> str:
    value = tag.need(attr)
    names = list(known)  # type: ignore[call-overload]
    if value not in names:
        raise InputError(f'<{tag.name} {attr}="{value}"> is none of {", ".join(names)}', tag.where)
    return value


def _numbers(tag: Tag, least: int, most: int) -> list[float]:
    words = [w.strip() for w in tag.text.split(",")]
    try:
        out = [float(w) for w in words]
    except ValueError:
        out = []
    if not least <= len(out) <= most or not all(map(math.isfinite, out)):
        count = f"{least} numbers" if least == most else f"{least} to {most} numbers"
        raise InputError(f"<{tag.name}> must be {count} separated by commas, not {tag.text.strip()!r}", tag.where)
    return out


def _options(tag: Tag | None) -> tuple[str, dict[str, float], bool]:
    if tag is None:
        return "levmar", dict(METHODS["levmar"]), False
    method = _choice(tag, METHODS) if "type" in tag.attrs else "levmar"
    options, verbose = dict(METHODS[method]), False
    for t in _only(tag, *options, "log_level", "print_level"):
        if t.name == "log_level":
            if t.text.strip() not in LEVELS:  # of which FEBio makes nothing either
                raise InputError(f"<log_level> is {t.text.strip()!r}, none of {', '.join(LEVELS)}", t.where)
        elif t.name == "print_level":
            if t.text.strip() not in PRINT:
                raise InputError(f"<print_level> is {t.text.strip()!r}, none of {', '.join(PRINT)}", t.where)
            verbose = PRINT[t.text.strip()]
        else:
            (options[t.name],) = _numbers(t, 1, 1)
            if options[t.name] <= 0 and t.name in ("obj_tol", "f_diff_scale", "max_iter"):
                raise InputError(f"<{t.name}> must be above 0, not {t.text.strip()}", t.where)
    return method, options, verbose


def _parameters(tag: Tag) -> tuple[Parameter, ...]:
    out: list[Parameter] = []
    for t in _only(tag, "param"):
        start, low, high, *scale = _numbers(t, 3, 4)
        name = t.need("name").strip()
        if not low <= start <= high or low == high:
            raise InputError(f"{name}: initial value, minimum and maximum are wanted, min <= initial <= max, not "
                             f"{start:g}, {low:g}, {high:g}", t.where)  # fmt: skip
        if scale and scale[0] <= 0:
            raise InputError(f"{name}: its scale must be above 0, not {scale[0]:g}", t.where)
        out.append(Parameter(low, start, high, paths=(name,), scale=scale[0] if scale else 0.0, name=name))
    if not 1 <= len(out) <= MOST:
        raise InputError(f"<Parameters> must have 1 to {MOST} of <param>, not {len(out)}", tag.where)
    return tuple(out)


def _constraints(tag: Tag | None, n: int) -> tuple[Floats, Floats]:
    """A (m, n) and b (m,): <constraint>a1,...,an,b</constraint>."""
    if tag is None:
        return np.zeros((0, n)), np.zeros(0)
    if n < 2:
        raise InputError("<Constraints> need two parameters at least", tag.where)
    rows = np.array([_numbers(t, n + 1, n + 1) for t in _only(tag, "constraint")]).reshape(-1, n + 1)
    return rows[:, :n], rows[:, n]


# ---- objectives -----------------------------------------------------------------------------------------
def _data_fit(tag: Tag, folder: Path) -> Objective:
    source: Source | None = None
    points: list[list[float]] = []
    for t in _only(tag, "fnc", "data"):
        if t.name == "fnc":
            source = _source(t)
        else:
            points = _imported(t, folder) if "import" in t.attrs else [_numbers(p, 2, 2) for p in t]
    if source is None:
        raise InputError("<Objective> has no <fnc>", tag.where)
    x, y = np.array(sorted(points, key=lambda p: p[0])).reshape(-1, 2).T

    def evaluate(rows: Floats) -> Floats:
        pairs = np.vstack([*([[0.0, 0.0]] if source.origin else []), rows.reshape(-1, 2)])
        pairs = pairs[np.argsort(pairs[:, 0], kind="stable")]
        found = np.asarray(np.interp(x, pairs[:, 0], pairs[:, 1]))
        return np.abs(found) if source.positive else found

    return Objective((source.ordinate, source.value), x, y, evaluate, source.value.text, source.ordinate.text)


@dataclass(frozen=True, slots=True)
class Source:
    """A curve of a run: ``value`` over ``ordinate``, from (0, 0) on where ``origin``, its size where ``positive``."""

    ordinate: Probe
    value: Probe
    origin: bool = False
    positive: bool = False


def _source(tag: Tag) -> Source:
    kind = _choice(tag, ("parameter", "filter_positive_only", "filter_sum"))
    time = probe("fem.time", tag.where)
    if kind == "parameter":
        named = {t.name: probe(t.need("name"), t.where) for t in _only(tag, "param", "ordinate")}
        if "param" not in named:
            raise InputError('<fnc type="parameter"> has no <param name="..."/>', tag.where)
        return Source(named.get("ordinate", time), named["param"])
    inner = list(_only(tag, "source") if kind == "filter_positive_only" else _only(tag, "node_data", "element_data"))
    if len(inner) != 1:
        raise InputError(f'<{tag.name} type="{kind}"> must have one source, not {len(inner)}', tag.where)
    if kind == "filter_positive_only":
        made = _source(inner[0])
        return Source(made.ordinate, made.value, made.origin, True)
    (t,) = inner
    where = t.need("node_set" if t.name == "node_data" else "elem_set")
    return Source(time, datum(t.name, t.need("data"), t.where, set=where), origin=True)


def _imported(tag: Tag, folder: Path) -> list[list[float]]:
    """Two numbers a line of a text file, to the first line that has none, as FEBio reads it."""
    if not tag.empty:
        raise InputError(f"<{tag.name} import=...> must be empty", tag.where)
    path = folder / tag.need("import")
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as e:
        raise InputError(f"cannot open {path}: {e.strerror}", tag.where) from None
    out = []
    for line in lines:
        try:
            out.append([float(w) for w in line.split()[:2]])
        except ValueError:
            break
        if len(out[-1]) < 2:
            out.pop()
            break
    if not out:
        raise InputError(f"{path} does not begin with two numbers separated by blanks", tag.where)
    return out


def _at_the_end(probes: list[Probe], y: list[float]) -> Objective:
    """Values at the end of a run."""
    number = np.arange(1.0, len(y) + 1)
    return Objective(tuple(probes), number, np.array(y), lambda rows: rows[-1], "at the end", "number")


def _target(tag: Tag, folder: Path) -> Objective:
    probes, y = [], []
    for t in _only(tag, "var", "fnc"):
        if t.name == "var":
            probes.append(probe(t.need("name"), t.where))
            y += _numbers(t, 1, 1)
            continue
        _choice(t, ("filter_avg",))
        parts = {c.name: c for c in _only(t, "elem_data", "target")}
        for name in ("elem_data", "target"):
            if name not in parts:
                raise InputError(f'<fnc type="filter_avg"> has no <{name}>', t.where)
        of = parts["elem_data"]
        probes.append(datum("element_data", of.need("data"), of.where, set=of.need("elem_set"), of=np.mean))
        y += _numbers(parts["target"], 1, 1)
    return _at_the_end(probes, y)


def _element_data(tag: Tag, folder: Path) -> Objective:
    return _table(tag, "elem", "element_data", several=False)


def _node_data(tag: Tag, folder: Path) -> Objective:
    return _table(tag, "node", "node_data", several=True)


def _table(tag: Tag, item: str, kind: str, several: bool) -> Objective:
    """Values of variables at the end, item by item."""
    names: list[str] = []
    probes: list[Probe] = []
    y: list[float] = []
    for t in _only(tag, "var", "data"):
        if t.name == "var":
            names = [n for n in (t.need("type").split(";") if several else [t.need("type")]) if n]
            continue
        if not names:
            raise InputError('<data> comes before <var type="...">', t.where)
        for row in _only(t, item):
            number = row.need("id")
            if not number.strip().isdigit():
                raise InputError(f'<{item} id="{number}">: a whole number is wanted', row.where)
            probes += [datum(kind, n, row.where, items=[int(number)]) for n in names]
            y += _numbers(row, len(names), len(names))
    return _at_the_end(probes, y)


OBJECTIVES: dict[str, Callable[[Tag, Path], Objective]] = {
    "data-fit": _data_fit, "target": _target, "element-data": _element_data, "node-data": _node_data,
}  # fmt: skip

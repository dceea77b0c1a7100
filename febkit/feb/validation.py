"""An input checked without solving it."""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path

import numpy as np

from febkit.files import keep_apart
from febkit.model import InputError, Model, Where
from febkit.model.data_files import data_file
from febkit.model.source import together
from febkit.units import SYSTEMS

from . import check_features, check_mesh, check_ranges, check_references, check_steps
from .document import Document
from .findings import Finding
from .read import read, sources

ORDER = {"error": 0, "unsupported": 1, "warning": 2, "hint": 3}


def validate(path: str | PathLike[str], solvable: bool = False) -> list[Finding]:
    """What is wrong, doubtful or unsupported in a .feb file, by severity and place.

    ``solvable`` also asks whether febkit can solve it. A file that cannot be read gives one error.
    """
    try:
        model = read(path)
    except InputError as e:
        return [Finding("error", e.message, e.where or Where(fspath(path)))]
    found = check(model)
    if solvable and not any(f.severity == "error" for f in found):
        from . import solvable as solver

        found = _sorted([*found, *solver.ask(model)])
    return found


def check(model: Model, files: bool = True) -> list[Finding]:
    """The same for a model in memory, the solver not asked. ``files``: see that its data files can be written, too."""
    broken = list(check_mesh.indices(model))
    if broken:  # the other checks look up nodes
        return _sorted(broken)
    checks = (_document, check_features.check, check_references.check, check_ranges.check, check_steps.check,
              check_mesh.check, _sense, *((_data_files,) if files else ()))  # fmt: skip
    return _sorted([f for ask in checks for f in ask(model)])


def require(model: Model) -> list[str]:
    """Raises InputError for what :func:`check` calls errors, what must not be solved; returns the warnings.

    Data files are left to the run, which knows where they go.
    """
    found = check(model, files=False)
    errors = [InputError(f.message, f.where) for f in found if f.severity == "error"]
    if errors:
        raise together(errors)
    return [f"{f.where}: {f.message}" if str(f.where) else f.message for f in found if f.severity == "warning"]


def _sorted(found: list[Finding]) -> list[Finding]:
    return sorted(dict.fromkeys(found), key=lambda f: (ORDER[f.severity], f.where.file, f.where.line))


def _document(model: Model) -> Iterator[Finding]:
    doc = model.document
    if not isinstance(doc, Document):
        return
    root = doc.root
    if model.version in ("2.5", "3.0", "4.0") and root.children and root.children[0].name != "Module":
        yield Finding("error", "the first section must be <Module>", root.children[0].where)
    names = [c.name for c in root]
    both = model.version == "4.0" and "MeshData" in names and "MeshDomains" in names
    if both and names.index("MeshData") < names.index("MeshDomains"):
        tag = root.children[names.index("MeshData")]
        yield Finding("error", "<MeshData> must come after <MeshDomains>", tag.where)


def _data_files(model: Model) -> Iterator[Finding]:
    """Files of <logfile> that a run beside the model would refuse; onto the model itself it always would."""
    beside = Path(model.file)
    for n, entry in enumerate(model.output.log if model.file else (), start=1):
        try:
            path = data_file(entry, n, beside.parent, beside.stem)
        except InputError as e:
            yield Finding("warning", e.message, e.where or Where(model.file))
            continue
        try:
            keep_apart([("data file", path, entry.where)], [("model", s, None) for s in sources(model)])
        except InputError as e:
            yield Finding("error", e.message, e.where or Where(model.file))


def _sense(model: Model) -> Iterator[Finding]:
    place = model.module_spec.where if model.module_spec is not None else Where(model.file)
    if not model.steps or all(s.control is None for s in model.steps):
        yield Finding("error", "there is no <Control>: nothing says how long to solve", Where(model.file))
    if not model.materials:
        yield Finding("error", "there are no materials", Where(model.file))
    extent = float(np.ptp(model.mesh.X, axis=0).max()) if len(model.mesh.X) else 0.0
    if model.units is None:
        yield Finding("hint", f"no units are said; the model is {extent:.3g} long: lengths, forces and times "
                      "must all be of one system", place)
    elif model.units not in SYSTEMS:
        yield Finding("hint", f'units "{model.units}" are none of FEBio\'s: {", ".join(SYSTEMS)}', place)
    elif model.units == "SI" and extent > 10.0:
        yield Finding("hint", f"units are SI and the model is {extent:.3g} m long", place)

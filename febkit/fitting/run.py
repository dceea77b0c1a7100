"""``febkit.fit``: parameters of models from experiments."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from febkit.model import InputError

from . import methods
from .experiment import Experiment, Measured
from .methods import Ended, Tolerance
from .parameters import Spec, read
from .problem import Problem, Trial
from .result import Fit, finished

if TYPE_CHECKING:
    from collections.abc import Iterable

METHODS = ("least_squares", "differential_evolution", "powell")


def fit(
    model: Any,
    parameters: Mapping[Any, Spec],
    data: Any = None,
    observe: Any = None,
    *,
    against: Any = None,
    sigma: Any = None,
    method: str = "least_squares",
    tolerance: float = 1e-6,
    step: float = 1e-3,
    most: int = 0,
    exact: bool | None = None,
    seed: int = 0,
    tell: Callable[[Trial], None] | None = None,
    progress: bool = False,
    **options: Any,
) -> Fit:
    """Fit parameters of a model to what was measured; of several models to several experiments at once.

    >>> f = febkit.fit(model, {"cartilage.solid.E": (0.1, 0.5, 2.0)}, data="force.csv",     # doctest: +SKIP
    ...                observe="reaction top z")
    >>> f["cartilage.solid.E"], f.intervals                                                # doctest: +SKIP

    model: a model or the path of one, with ``data``, ``observe``, ``against`` and ``sigma`` as
    :class:`.experiment.Experiment` has them; or an Experiment, or several.
    parameters: path -> (low, start, high) or a :class:`.parameters.Parameter`; several paths in a tuple share one
    value; path -> text is a formula of other parameters.
    method: "least_squares" (bounded Levenberg-Marquardt); "differential_evolution" looks for its start in the whole of
    the bounds; "powell" takes no derivatives.
    tolerance: the part of the sum of squares below which a step is not worth a run; step: of differences, relative;
    most: runs at most; seed: of differential evolution; tell: hears of each trial; progress: a line in the terminal.
    exact: runs bring the derivatives of their equations (``result.sensitivity``), by default those of models of a
    hundred elements or more; else derivatives are differences of runs, and secants.
    Other options (threads, linear, ...) are those of :func:`febkit.solve`.

    A run that fails is a step too long; Ctrl-C gives back the best so far. Raises InputError for bad input, and where
    the model does not solve at its starting values.
    """
    if method not in METHODS:
        raise InputError(f"method {method!r}: choose from {', '.join(METHODS)}")
    given = _experiments(model, data, observe, against, sigma)
    names = _names(given)
    options.setdefault("threads", 1)
    measured = [Measured(e, n, options, exact) for e, n in zip(given, names)]
    every = read(parameters, {n: e.parameters for e, n in zip(given, names) if e.parameters})
    for m in measured:
        for path in every.settings(every.values(every.start), m.name):
            _is_number(m, path)
    count = sum(len(m.y) for m in measured)
    if count < len(every):
        raise InputError(f"{len(every)} parameters ({', '.join(every.names)}) cannot be told from {count} values of "
                         "data: fix some of them, or give more data")  # fmt: skip
    problem = Problem(every, measured, step=step, most=most, tell=tell)
    if not progress:
        return _carried_out(problem, method, tolerance, seed)
    from .progress import Progress

    with Progress(every.names, tell) as shown:
        problem.tell = shown.trial
        return _carried_out(problem, method, tolerance, seed)


def _carried_out(problem: Problem, method: str, tolerance: float, seed: int) -> Fit:
    known = all(e.known for e in problem.experiments if isinstance(e, Measured))
    by = Tolerance(tolerance, 0.01 * tolerance**0.5)
    return finished(problem, lambda: _by(problem, method, by, seed), known=known)


def _by(problem: Problem, method: str, tolerance: Tolerance, seed: int) -> Ended:
    if method == "powell":
        found = methods.powell(problem, tolerance)
        return Ended(found.z, found.converged, found.reason, problem.jacobian(found.z))
    start = methods.everywhere(problem, seed) if method == "differential_evolution" else None
    return methods.steadied(problem, lambda z: methods.least_squares(problem, tolerance, start=z), start)


def _experiments(model: Any, data: Any, observe: Any, against: Any, sigma: Any) -> list[Experiment]:
    if isinstance(model, Experiment):
        model = [model]
    if isinstance(model, Sequence) and not isinstance(model, str):
        if data is not None or observe is not None:
            raise InputError("several experiments have their own data and observables: leave out data= and observe=")
        return list(model)
    if data is None or observe is None:
        raise InputError('a fit needs data= and observe=, such as observe="reaction top z"')
    return [Experiment(model, data, observe, against, sigma)]


def _names(given: Iterable[Experiment]) -> list[str]:
    names = [e.name or f"experiment {k}" for k, e in enumerate(given, 1)]
    if len(set(names)) < len(names):
        raise InputError("two experiments have one name")
    return names


def _is_number(m: Measured, path: str) -> None:
    value = m.model[path]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{m.name}: {path} is {value!r}: what is fitted is a number")

"""What a study found: tables 2 and 3, limits, medians, figures 4 to 8, and one dataset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from febkit.files import put
from febkit.metrics import tables
from febkit.metrics.agreement import compare_orders, spread, usual
from febkit.metrics.cells import METRICS
from febkit.metrics.osmotic import split
from febkit.model import InputError, Where
from febkit.plots.canvas import require

from . import gather, ions, maps, pattern
from .models import CASES, template_of, values_of
from .plan import CONTROL, Place, Plan, which
from .step import Step
from .store import Store
from .work import MODEL, RESULTS

if TYPE_CHECKING:
    import xarray as xr

Metrics = Mapping[Place, "xr.Dataset"]
RANKED = 3  # cells from which on ranks say something
SPOKEN = 20  # points of which each gets its own rows


def write_report(plan: Plan, folder: str | Path, figures: bool = True) -> Iterator[Path]:
    """Write metrics.nc, report.md and the figures; yields each path. What is not done yet is named.

    Raises InputError, before anything is written, where ``figures`` are wanted and matplotlib is not there.
    """
    import xarray as xr

    if figures:
        require()
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "metrics.nc"
    found, agreed = gather.Finished(plan), gather.agreements(plan)
    gather.write_results(plan, path)
    yield path
    with xr.open_dataset(path, chunks=None) as data:
        pictures = [*_figures(plan, found, agreed, folder), *_maps(plan, data, folder)] if figures else []
        yield from pictures
        path = folder / "report.md"
        put(path, _text(plan, found, agreed, data, pictures).encode())
    yield path


def _maps(plan: Plan, data: xr.Dataset, folder: Path) -> Iterator[Path]:
    yield from maps.depth_figures(data, ramp(plan), folder)
    yield from maps.size_figures(plan, data, ramp(plan), folder)


def _text(plan: Plan, found: Metrics, agreed: Metrics, data: xr.Dataset, pictures: list[Path]) -> str:
    study = plan.study
    missing = [_named(plan, p) for p in plan.metrics if p not in found]
    out = [f"# {study.name}", ""]
    zones = [f"{z.name} {z.top:g} to {z.bottom:g}" for z in study.zones]
    out += [
        f"Cases {', '.join(study.cases)}; methods {', '.join(m.name for m in study.methods)}; "
        f"{len(study.points)} point(s)"
        + (f"; zones by depth: {', '.join(zones)}" if zones else "")
        + (f"; variants {', '.join(v.name for v in study.variants)}" if len(study.variants) > 1 else "")
        + (f"; seeds {', '.join(map(str, study.seeds))}." if len(study.seeds) > 1 else "."),
        "",
    ]
    if missing:
        out += [f"Not done yet: {', '.join(missing[:20])}{' ...' if len(missing) > 20 else ''}.", ""]
    out += _instant_said(plan, found)
    out += [t.markdown() for t in _failed(plan)]
    out += [t.markdown() for t in all_tables(plan, found, agreed)]
    out += [t.markdown() for t in maps.depth_table(data)]
    out += [t.markdown() for t in maps.size_tables(plan, data, agreed, ramp(plan))]
    out += [_times(plan).markdown()]
    out += [f"![{p.stem}]({p.name})\n" for p in pictures]
    return "\n".join(out)


def _named(plan: Plan, p: Place) -> str:
    return f"{p.case} {p.method}{which(plan.study, p.point, p.seed, p.variant)}"


def _failed(plan: Plan) -> Iterator[tables.Table]:
    """Steps that failed, and solves that a second try with smaller steps brought to their end."""
    rows: list[list[object]] = [[label, "failed", why] for label, why in gather.failures(plan)]
    store = Store(plan.study.folder)
    for key, step in plan.steps().items():
        if step.kind == "solve" and (r := store.record(key)).get("retried"):
            rows.append([step.label, "solved at the second try", f"{r['retried']}; before: {r['before']}"])
    if rows:
        yield tables.Table("Failed, or tried again", ["step", "", "why"], rows)


def all_tables(
    plan: Plan, found: Metrics | None = None, agreed: Metrics | None = None
) -> Iterator[tables.Table]:
    """Tables of what is done: the study's pattern, RMS (table 2), limits, ranks (table 3), medians and ranges."""
    found = gather.Finished(plan) if found is None else found
    agreed = gather.agreements(plan) if agreed is None else agreed
    if agreed:
        study = plan.study
        yield from first_tables(plan, found, agreed)
        rows = [
            (f"{p.case} {p.method}{which(study, None, p.seed, p.variant)}", ds) for p, ds in sorted(agreed.items())
        ]
        yield tables.rms_table(rows, "RMS difference to the control (over the control's range)")
        for label, ds in rows:
            yield tables.limits_table(ds, f"{label}: limits of agreement (method - control)")
        ranks = list(_ranks(plan, found))
        if ranks:
            yield tables.rank_table(ranks)
    few = len(plan.study.points) * len(plan.study.seeds) * len(plan.study.variants) <= SPOKEN
    shown = [p for p in found if p.point < SPOKEN and (few or p.seed == p.variant == 0)]
    spreads = [(_named(plan, p), spread(found[p], instant(plan, found[p]))) for p in shown]
    if spreads:
        yield tables.spread_table(spreads)


def first_tables(plan: Plan, found: Metrics | None = None, agreed: Metrics | None = None) -> Iterator[tables.Table]:
    """The study's answer: of charged mixtures the errors of motion and ions, else the published study's pattern."""
    agreed = gather.agreements(plan) if agreed is None else agreed
    if not mixed(plan):
        yield from pattern_tables(plan, found, agreed)
    elif agreed:
        yield ions.table(agreed)


def pattern_tables(
    plan: Plan, found: Metrics | None = None, agreed: Metrics | None = None
) -> Iterator[tables.Table]:
    """Whether the published study's pattern comes out, and its table 2 beside ours."""
    study = plan.study
    if not set(study.cases) <= set(CASES) or study.differ("cell", "embedded"):
        return
    found = gather.Finished(plan) if found is None else found
    agreed = gather.agreements(plan) if agreed is None else agreed
    default = str(study.coupling.get("recovery") or "default")
    own = {v.name: _variant(agreed, k) for k, v in enumerate(study.variants)}
    said = {
        v.name: list(pattern.statements(study.methods, own[v.name], _variant(found, k), default))
        for k, v in enumerate(study.variants)
    }
    if len(said) > 1 and any(said.values()):
        yield pattern.side_by_side(said)
    elif said[study.variants[0].name]:
        yield pattern.table(said[study.variants[0].name])
    for name, ds in own.items():
        if ds:
            yield pattern.beside_published(study.methods, ds, name)


def _variant(of: Metrics, variant: int) -> Metrics:
    """Those of one variant."""
    return {p: of[p] for p in of if p.variant == variant}


def _ranks(plan: Plan, found: Metrics) -> Iterator[tuple[str, Any]]:
    """The first method against each other one, by case."""
    first, *others = [m.name for m in plan.study.methods]
    for p in [p for p in found if p.method == CONTROL]:
        for other in others:
            a, b = found.get(p._replace(method=first)), found.get(p._replace(method=other))
            if a is not None and b is not None and min(a.sizes["cell"], b.sizes["cell"]) >= RANKED:
                label = f"{p.case}{which(plan.study, None, p.seed, p.variant)}: {first} / {other}"
                yield label, compare_orders(found[p], a, b, instant(plan, a))


def mixed(plan: Plan) -> bool:
    """Do the study's models have solutes? The published one's have none."""
    return str(plan.study.tissue.get("physics", "biphasic")) != "biphasic"


def ramp(plan: Plan) -> float | None:
    """End of the ramp, the "instantaneous" moment: the study's own, or its template's; None where neither says it."""
    study = plan.study
    if study.instantaneous is not None or "file" in study.tissue:
        return study.instantaneous
    found = values_of(template_of(study.tissue, "tissue"), study.tissue, Where(str(study.file))).get("ramp")
    return float(found) if isinstance(found, int | float) else None


def instant(plan: Plan, ds: xr.Dataset) -> float:
    """The "instantaneous" moment of a result: the study's own; else the ramp's end, or the first state after it."""
    end, t = ramp(plan), ds["time"].values
    wanted = pattern.RAMP if end is None else end
    if abs(t - wanted).min() <= 1e-3 * wanted:
        return wanted
    if plan.study.instantaneous is not None:
        said = ", ".join(f"{x:g}" for x in t[:12]) + (" ..." if len(t) > 12 else "")
        raise InputError(f"{plan.study.file}: instantaneous = {wanted:g}, when no result has a state; they have {said}")
    later = t[t > (0.0 if end is None else end)]
    return float(later[0] if len(later) else t[-1])


def _instant_said(plan: Plan, found: Metrics) -> list[str]:
    """A line where "instantaneous" is not the ramp's end."""
    first = next(iter(found.values()), None)
    end = ramp(plan)
    if first is None or end is None or (t := instant(plan, first)) == end:
        return []
    return [f"There is no state at the ramp's end, t = {end:g}; \"instantaneous\" is t = {t:g}.", ""]


def _times(plan: Plan) -> tables.Table:
    """Seconds and memory of the solves, and their sum over all of them."""
    store = Store(plan.study.folder)
    rows: list[list[object]] = []
    wall = processor = 0.0
    for key, step in plan.steps().items():
        if step.kind == "solve" and store.has(key):
            r = store.record(key)
            wall, processor = wall + r["seconds"], processor + r.get("processor_seconds", 0.0)
            rows.append(
                [
                    step.label,
                    _elements(store, step),
                    r["seconds"],
                    r.get("processor_seconds", ""),
                    r.get("steps", ""),
                    r.get("iterations", ""),
                    r.get("peak_memory_mb", ""),
                ]
            )
    total: list[object] = [f"{len(rows)} solves", "", round(wall, 1), round(processor, 1), "", "", ""]
    head = ["step", "elements", "seconds", "processor seconds", "steps", "iterations", "peak memory (MB)"]
    return tables.Table("Solves", head, [*rows[:200], total])


def _elements(store: Store, step: Step) -> object:
    """Elements of the model that was solved, "" where that is not known."""
    while "elements" not in (r := store.record(step.key) if store.has(step.key) else {}):
        inputs = step.inputs.get("model") or step.inputs.get("cell")
        if inputs is None:
            return ""
        step = inputs
    return r["elements"]


def _figures(plan: Plan, found: Metrics, agreed: Metrics, folder: Path) -> Iterator[Path]:
    from febkit import plots

    several = range(len(plan.study.variants)) if plan.study.differ("tissue") else range(1)
    for case, v in [(case, v) for case in plan.study.cases for v in several]:
        name = f"case {case}" + (f", {plan.study.variants[v].name}" if v or len(several) > 1 else "")
        suffix = f"{case}_{v + 1}" if len(several) > 1 else case
        own = [p for p in found if (p.case, p.variant) == (case, v)]
        for at in [p for p in own if p.method == CONTROL or not plan.study.control]:
            shown = {_label(p.method): found[p] for p in own if p == at._replace(method=p.method)}
            yield _saved(plots.histories(shown, _six(shown), title=name), folder / f"histories_{suffix}.png")
            held = [m for m in usual(split(next(iter(shown.values())))) if m not in METRICS]
            if held:
                yield _saved(plots.histories(shown, held, title=name), folder / f"osmotic_{suffix}.png")
            if any("mass_exchange_rate" in ds for ds in shown.values()):
                early = plots.early_exchange(shown, 10 * (ramp(plan) or 0.1), title=name)
                yield _saved(early, folder / f"exchange_{suffix}.png")
            for method in plan.study.methods:
                test, control = (found.get(at._replace(method=m)) for m in (method.name, CONTROL))
                if control is not None and test is not None:
                    figure = plots.bland_altman(control, test, title=f"{name}, {_label(method.name)}")
                    which_one = method.name.replace("/", "-").replace(" ", "_")
                    yield _saved(figure, folder / f"bland_altman_{suffix}_{which_one}.png")
            figure = _section(plan, at, name)
            if figure is not None:
                yield _saved(figure, folder / f"section_{suffix}.png")
            break  # one point and seed for each case: the control's, or the first
    by_case: dict[str, dict[str, xr.Dataset]] = {}
    for p, ds in agreed.items():
        if p.seed == 0 and p.variant in several:
            by_case.setdefault(f"{p.case} {p.variant + 1}" if len(several) > 1 else p.case, {})[p.method] = ds
    if by_case:
        yield _saved(plots.outside_counts(by_case), folder / "outside_limits.png")
        yield _saved(plots.errors(by_case), folder / "errors.png")


def _six(shown: dict[str, xr.Dataset]) -> list[str]:
    """Those of the study's metrics that the first result has."""
    first = next(iter(shown.values()))
    return [m for m in METRICS if m in first]


def _section(plan: Plan, where: Place, name: str, time: float = 5.0) -> Any:
    """Effective strain with flux arrows through the middle of a cell, control beside methods (fig 8)."""
    from febkit import plots

    shown = {}
    parts: list[str] | None = None
    at = 0.0
    for p, step in plan.metrics.items():
        if p == where._replace(method=p.method):
            pair = _opened(plan, step)
            if pair is not None:
                shown[_label(p.method)] = pair
    if not shown:
        return None
    times = next(iter(shown.values()))[0]["time"].values
    if abs(times - time).min() > 1e-3 * time:
        time = float(times[-1])
    names = [set(_parts(ds)) for ds, _ in shown.values()]
    parts = sorted(set.intersection(*names)) if len(names) > 1 else None
    at = _middle(next(iter(shown.values()))[0])
    return plots.sections(
        shown, "effective_strain", time, "y", at, parts, title=f"{name}, t = {time:g} s"
    )


def _parts(ds: xr.Dataset) -> list[str]:
    from febkit.metrics.selection import part_names

    return part_names(ds)


def _middle(ds: xr.Dataset) -> float:
    """y of the cell nearest the middle, so that the section cuts a cell."""
    import numpy as np

    from febkit.metrics.selection import select_cells

    pick = select_cells(ds)
    X, conn = ds["X"].values, ds["connectivity"].values
    y = [float(X[conn[pick.of(i)], 1].mean()) for i in range(len(pick.names))]
    return y[int(np.abs(y).argmin())]


def _opened(plan: Plan, measure: Any) -> Any:
    """(result, model) behind a measure step, None where its files were dropped."""
    from febkit import open_results
    from febkit.feb import read

    store = Store(plan.study.folder)
    results, model = (measure.inputs.get(n) for n in ("results", "model"))
    if results is None or not store.has(results.key):
        return None
    path = store.path(model.key) / MODEL if model is not None else None
    units = plan.study.measure.get("units")
    return open_results(store.path(results.key) / RESULTS, units=units), read(path) if path and path.is_file() else None


def _label(method: str) -> str:
    return f"order {method}" if method[0].isdigit() else method


def _saved(figure: Any, path: Path) -> Path:
    from febkit import plots

    plots.save(figure, path)
    return path

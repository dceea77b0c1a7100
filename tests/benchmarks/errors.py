"""Estimated errors of hand-offs beside true ones: cases A to D, points, tissue meshes, recoveries and orders.

    python tests/benchmarks/errors.py field [--folder errors.field] [--picture docs/pictures/errors.png]
    python tests/benchmarks/errors.py cells [--folder errors.study] [--picture docs/pictures/errors_cells.png]

``field``: solves each case's tissue on coarse meshes and on a fine one (kept in the folder), hands off from points at
Z = 0, 0.25 and 0.42 mm over a cube of 0.1 mm, and prints Markdown tables of the estimate (febkit.coupling.errors)
beside the true error against the fine mesh: largest over 125 places and over times by the largest value there.
``rho``: Spearman's rank correlation; ``bound``: share of hand-offs whose estimate is no less than the error;
``median``, ``10 %``, ``90 %``: of the estimate over the error. What is free in the estimate was
chosen on A and C. Then automatic against fixed order.

``cells``: small cell models driven by three tissue meshes (errors.toml), their metrics beside those of the embedded
control: estimated uncertainties beside true errors, largest over times by the control's range, cell by cell. The form
of the propagation was chosen on B.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from febkit import coupling, results, study, templates
from febkit.coupling import errors
from febkit.coupling.taylor import RECOVERIES
from febkit.solving import solve

HERE = Path(__file__).resolve().parent
EDGE = 0.1
HEIGHTS = (0.0, 0.25, 0.42)
# elements in x and y, in z, edge of the middle one; the last is the reference
MESHES = {c: [(3, 15, 0.0), (3, 25, 0.0), (3, 35, 0.0), (7, 35, 0.2), (3, 200, 0.0)] for c in "AB"}
MESHES |= {c: [(7, 15, 0.0), (7, 25, 0.0), (11, 35, 0.0), (7, 35, 0.2), (13, 61, 0.0)] for c in "CD"}
WORDS = {"u": "displacement", "strain": "strain", "p": "pressure", "grad_p": "pressure gradient"}
METRICS = {
    "aspect_ratio_change": "aspect ratio", "volumetric_strain": "volumetric strain",
    "effective_strain": "effective strain", "effective_stress": "effective stress",
    "max_shear_strain": "max shear strain", "mass_exchange_rate": "mass exchange",
}  # fmt: skip
TISSUES = {"uniform": [], "middle": ["tissue.vertical=35", "tissue.centre=0.2"], "coarse": ["tissue.vertical=15"]}
Row = dict[str, Any]


def tissue(folder: Path, case: str, n: int, vertical: int, centre: float) -> coupling.Field:
    """A solved tissue, kept in the folder."""
    path = folder / f"{case}_{n}x{vertical}{'_middle' if centre else ''}.xplt"
    if not path.is_file():
        part = path.with_suffix(".part")
        result = solve(templates.new("tissue", case=case, n=n, vertical=vertical, centre=centre), part, threads=1)
        assert result.converged, result.reason
        part.rename(path)
        print(f"solved {path.name}", flush=True)
    with results.open(path) as ds:
        return coupling.from_dataset(ds)


def largest(values: np.ndarray) -> np.ndarray:
    return np.linalg.norm(values, axis=-1).max(axis=0)


def handed_off(case: str, folder: Path) -> Iterator[Row]:
    """Every point, mesh, recovery, order and quantity: estimated and true error (time,), the largest true value."""
    *coarse, fine = (tissue(folder, case, *m) for m in MESHES[case])
    times = fine.times[fine.times > 0]
    points = np.array([[0.0, 0.0, z] for z in HEIGHTS])
    g = np.linspace(-0.5 * EDGE, 0.5 * EDGE, 5)
    places = np.stack(np.meshgrid(g, g, g), axis=-1).reshape(-1, 3)
    true = errors.around(fine.at(times), points, places)
    for mesh, field in zip(MESHES[case], coarse):
        for recovery in RECOVERIES:
            for n in errors.ORDERS:
                ds = coupling.series(field, points, order=n, recovery=recovery, box=EDGE, times=times)
                for k, z in enumerate(HEIGHTS):
                    of = coupling.handoff(ds, places, point=k, order=n, fluid_order=n)
                    start = len(of.times) - len(times)  # a hand-off starts from rest
                    found = coupling.estimate(ds, k, n, n)
                    for name, (what, *_) in errors.QUANTITIES.items():
                        if what not in field.columns:
                            continue
                        own = errors.tissue_values(name, true[k : k + 1, ..., field.columns[what]])
                        c = of.motion if what == "u" else of.fluid[..., None]  # type: ignore[index]
                        given = errors.series_values(name, c[None, start:], places)
                        yield {
                            "case": case, "mesh": mesh, "recovery": recovery, "order": n, "z": z, "of": name,
                            "true": largest(given - own)[0], "scale": float(largest(own).max()),
                            "estimate": found[f"{name}_error"].values,
                            "rank": float(np.sqrt((found[f"{name}_error"].values ** 2).mean())),
                        }  # fmt: skip


def figures(estimate: np.ndarray, true: np.ndarray) -> str:
    """rho | bound | median | 10 % | 90 % of pairs."""
    ratio = estimate / true
    q = np.quantile(ratio, [0.5, 0.1, 0.9])
    return (f"{len(true)} | {spearmanr(estimate, true)[0]:.2f} | {100 * np.mean(ratio >= 1):.0f} % | "
            f"{q[0]:.2f} | {q[1]:.2f} | {q[2]:.1f}")  # fmt: skip


def pairs(rows: list[Row], by_time: bool) -> tuple[np.ndarray, np.ndarray]:
    """Estimates and errors by the largest value, largest over times or at each (errors below 1e-5 left out)."""
    e = np.array([r["estimate"] / r["scale"] for r in rows])
    t = np.array([r["true"] / r["scale"] for r in rows])
    if not by_time:
        return np.nanmax(e, axis=1), t.max(axis=1)
    real = t > 1e-5
    return e[real], t[real]


def agreement(rows: list[Row]) -> str:
    lines = ["| cases | of | times | hand-offs | rho | bound | median | 10 % | 90 % |", "|---" * 9 + "|"]
    for cases in ("AC", "BD"):
        for name, words in WORDS.items():
            mine = [r for r in rows if r["case"] in cases and r["of"] == name]
            for by_time in (False, True):
                said = "each" if by_time else "largest"
                lines.append(f"| {', '.join(cases)} | {words} | {said} | {figures(*pairs(mine, by_time))} |")
    return "\n".join(lines)


def by(rows: list[Row], name: str, key: Callable[[Row], str]) -> str:
    """Strain's agreement, largest over times, by what ``key`` tells apart."""
    lines = [f"| {name} | hand-offs | rho | bound | median | 10 % | 90 % |", "|---" * 7 + "|"]
    strains = [r for r in rows if r["of"] == "strain"]
    for k in dict.fromkeys(map(key, strains)):
        lines.append(f"| {k} | {figures(*pairs([r for r in strains if key(r) == k], False))} |")
    return "\n".join(lines)


def orders(rows: list[Row]) -> str:
    """Geometric means of true errors, root mean square over times by the largest value, by fixed and chosen order."""
    lines = ["| cases | recovery | of | order 1 | 2 | 3 | auto | best |", "|---" * 8 + "|"]
    for cases in ("AC", "BD"):
        for recovery in ("patches", "polynomial"):
            for name in ("strain", "grad_p", "u", "p"):
                picks: dict[str, list[float]] = {k: [] for k in ("1", "2", "3", "auto", "best")}
                mine = [r for r in rows if r["case"] in cases and r["recovery"] == recovery]
                ranked = {"u": "strain", "p": "grad_p"}.get(name, name)
                for place in dict.fromkeys((r["case"], r["mesh"], r["z"]) for r in mine):
                    here = [r for r in mine if (r["case"], r["mesh"], r["z"]) == place]
                    miss = {r["order"]: float(np.sqrt((r["true"] ** 2).mean())) / r["scale"] for r in here
                            if r["of"] == name}  # fmt: skip
                    chosen = min((r for r in here if r["of"] == ranked), key=lambda r: r["rank"])["order"]
                    for n, v in miss.items():
                        picks[str(n)].append(v)
                    picks["auto"].append(miss[chosen])
                    picks["best"].append(min(miss.values()))
                means = " | ".join(f"{np.exp(np.mean(np.log(v))):.3g}" for v in picks.values())
                lines.append(f"| {', '.join(cases)} | {recovery} | {WORDS[name]} | {means} |")
    return "\n".join(lines)


def scatter(ax: Any, e: np.ndarray, t: np.ndarray, marker: str, color: str, label: str) -> None:
    ax.loglog(t, e, marker, color=color, ms=3.5, mfc="none", mew=0.8, label=label)


def frame(ax: Any, title: str, by: str = "largest value") -> None:
    low, high = 10 ** np.floor(np.log10(min(*ax.get_xlim(), *ax.get_ylim()))), 10 ** np.ceil(np.log10(ax.get_xlim()[1]))
    low = max(low, 1e-4)
    ax.plot([low, high], [low, high], "k-", lw=0.8)
    ax.plot([low, high], [2 * low, 2 * high], "k:", lw=0.6)
    ax.plot([low, high], [0.5 * low, 0.5 * high], "k:", lw=0.6)
    ax.set_title(title, fontsize=9)
    ax.set(xlabel=f"true error / {by}", ylabel=f"estimate / {by}", aspect="equal",
           xlim=(low, high), ylim=(low, high))  # fmt: skip


def picture(rows: list[Row], path: Path) -> None:
    """A panel for each quantity: all cases, points, meshes, recoveries; colour by order, marker by case."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 9.6), layout="constrained")
    for ax, (name, words) in zip(figure.subplots(2, 2).ravel(), WORDS.items()):
        own = [r for r in rows if r["of"] == name]
        for case, marker in zip("ABCD", "os^d"):
            for n, color in zip(errors.ORDERS, ("tab:red", "tab:blue", "tab:green")):
                mine = [r for r in own if r["case"] == case and r["order"] == n]
                if mine:
                    scatter(ax, *pairs(mine, False), marker, color, f"{case}, order {n}")
        e, t = pairs(own, False)
        frame(ax, f"{words}: rank correlation {spearmanr(e, t)[0]:.2f}, bound in {100 * np.mean(e >= t):.0f} %")
    figure.axes[0].legend(fontsize=7, ncol=2, loc="lower right")
    figure.savefig(path, dpi=110)


def field_main(folder: Path, cases: str, path: Path | None) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    rows = [r for case in cases for r in handed_off(case, folder)]
    print(agreement(rows), "\n")
    print(by(rows, "order", lambda r: str(r["order"])), "\n")
    print(by(rows, "recovery", lambda r: r["recovery"]), "\n")
    print(by(rows, "element at the point, mm", lambda r: "0.2, the middle one" if r["mesh"][2] and r["z"] == 0 else
             f"1/{r['mesh'][1]}"), "\n")  # fmt: skip
    print(orders(rows))
    if path is not None:
        picture(rows, path)


def told(done: int, total: int, outcome: Any) -> None:
    print(f"[{done}/{total}] {outcome.label}: {outcome.message or f'{outcome.seconds:.1f} s'}", flush=True)


def driven(case: str, folder: Path) -> Iterator[Row]:
    """Every tissue, order, metric and cell: uncertainty and true error, largest over times, and the control's range."""
    for name, over in TISSUES.items():
        set_to = [f"cases={json.dumps([case])}", f"folder={json.dumps(str(folder.resolve()))}", f"coupling.box={EDGE}"]
        set_to += ["embedded.lateral=4"] if case in "CD" else []  # whose field varies in x and y
        plan = study.make_plan(study.read(HERE / "errors.toml", [*set_to, *over]))
        study.carry_out(plan, "serial", told)
        found = dict(study.finished(plan))
        control = found[study.Place(case, "control")]
        for place, ds in found.items():
            if place.method == "control":
                continue
            for metric in METRICS:
                a, b = (d[metric].sel(time=ds["time"][ds["time"] > 0], method="nearest").values for d in (control, ds))
                sure = ds[f"{metric}_uncertainty"].sel(time=ds["time"] > 0).values
                span = float(np.ptp(a))
                yield from (
                    {"case": case, "mesh": name, "order": int(place.method), "of": metric, "cell": k, "scale": span,
                     "true": abs(b[k] - a[k]), "estimate": sure[k]} for k in range(len(a))
                )  # fmt: skip


def cells_main(folder: Path, cases: str, path: Path | None) -> None:
    cells_report([r for case in cases for r in driven(case, folder)], path)


def cells_report(rows: list[Row], path: Path | None) -> None:
    print("| metric | cases | cells | rho | bound | median | 10 % | 90 % |\n" + "|---" * 8 + "|")
    for metric, words in METRICS.items():
        for some in ("B", "ACD"):
            mine = [r for r in rows if r["of"] == metric and r["case"] in some]
            if mine:
                print(f"| {words} | {', '.join(some)} | {figures(*pairs(mine, False))} |")
    columns = " | ".join(f"order {n}: estimate | true" for n in errors.ORDERS)
    print(f"\n| effective strain, case | tissue | {columns} |")
    print("|---" * 8 + "|")
    strains = [r for r in rows if r["of"] == "effective_strain"]
    for case, mesh in dict.fromkeys((r["case"], r["mesh"]) for r in strains):
        cells = []
        for n in errors.ORDERS:
            e, t = pairs([r for r in strains if (r["case"], r["mesh"], r["order"]) == (case, mesh, n)], False)
            cells.append(f"{np.median(e):.3f} | {np.median(t):.3f}")
        print(f"| {case} | {mesh} | {' | '.join(cells)} |")
    if path is not None:
        cells_picture(rows, path)


def cells_picture(rows: list[Row], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 8.6), layout="constrained")
    for ax, (metric, words) in zip(figure.subplots(2, 3).ravel(), METRICS.items()):
        own = [r for r in rows if r["of"] == metric]
        for mesh, marker in zip(TISSUES, "os^"):
            for n, color in zip(errors.ORDERS, ("tab:red", "tab:blue", "tab:green")):
                mine = [r for r in own if r["mesh"] == mesh and r["order"] == n]
                if mine:
                    scatter(ax, *pairs(mine, False), marker, color, f"{mesh}, order {n}")
        e, t = pairs(own, False)
        frame(ax, f"{words}: rank correlation {spearmanr(e, t)[0]:.2f}, bound in {100 * np.mean(e >= t):.0f} %",
              "the control's range")
    figure.axes[0].legend(fontsize=7, loc="lower right")
    figure.savefig(path, dpi=110)


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("what", choices=["field", "cells"])
    ap.add_argument("--cases", default="ABCD")
    ap.add_argument("--folder", type=Path)
    ap.add_argument("--picture", type=Path, help="PNG file of the scatter")
    a = ap.parse_args()
    run = field_main if a.what == "field" else cells_main
    run(a.folder or HERE / ("errors.field" if a.what == "field" else "errors.study"), a.cases, a.picture)


if __name__ == "__main__":
    main()

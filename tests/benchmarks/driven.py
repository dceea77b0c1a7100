"""Cell models driven by order and recovery, beside the embedded control: cases A to D over 100 s.

    python tests/benchmarks/driven.py [--cases B] [--methods "1 patches" "2 patches"] [--folder driven.study]

Carries out driven.toml (what is done is kept and not done again) and prints Markdown tables:

- surface: largest |u - series| and |p - series| on the driven surface over all times, by the largest |u|, |p|
  (plotfiles hold single precision, 6e-8);
- metrics of the cells: RMS difference to the control over cells and times, over the control's range (eq 20);
- field inside: u and p at the inner nodes, each less its mean over these nodes (rigid motion is not handed over, a
  uniform pressure strains nothing), root of the sum of squared differences to the control over nodes and times by
  that of the control.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from febkit import coupling, results, study
from febkit.study.plan import CONTROL, Plan
from febkit.study.store import Store
from febkit.study.work import RESULTS, SERIES

HERE = Path(__file__).resolve().parent
METRICS = {
    "aspect_ratio_change": "aspect ratio", "volumetric_strain": "volumetric strain",
    "effective_strain": "effective strain", "effective_stress": "effective stress",
    "max_shear_strain": "max shear strain", "mass_exchange_rate": "mass exchange",
}  # fmt: skip
Fields = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def fields(plan: Plan, where: study.Place) -> Fields:
    """X, times, u, p of a measured model."""
    step = plan.metrics[where].inputs["results"]
    with results.open(Store(plan.study.folder).path(step.key) / RESULTS) as ds:
        return (
            ds["X"].values.astype(float), ds["time"].values.astype(float),
            ds["displacement"].values.astype(float), ds["effective_fluid_pressure"].values.astype(float),
        )  # fmt: skip


def surface(plan: Plan, where: study.Place, f: Fields) -> tuple[float, float]:
    """How far u and p of the driven surface are from the series, by the largest of each."""
    model = plan.metrics[where].inputs["model"]
    driving = coupling.read_driving(Store(plan.study.folder).path(model.inputs["series"].key) / SERIES)
    X, times, u, p = f
    nodes = np.flatnonzero(np.abs(np.abs(X) - np.abs(X).max(axis=0)).min(axis=1) < 1e-9 * np.ptp(X))
    order, fluid = model.params["solid"], model.params["fluid"]
    given = coupling.handoff(driving, X[nodes], point=where.point, order=order, fluid_order=fluid)
    at = np.abs(given.times[None] - times[:, None]).argmin(axis=1)
    assert np.allclose(given.times[at], times, rtol=1e-6) and given.p is not None
    return (
        float(np.abs(u[:, nodes] - given.u[at]).max() / np.abs(given.u).max()),
        float(np.abs(p[:, nodes] - given.p[at]).max() / np.abs(given.p).max()),
    )


def inside(driven: Fields, control: Fields) -> tuple[float, float]:
    """Relative differences of u and p at the nodes inside."""
    X, times, u, p = driven
    n = len(X)  # the control's first nodes are the cell model's
    assert np.allclose(control[0][:n], X)
    at = np.abs(control[1][None] - times[:, None]).argmin(axis=1)
    assert np.allclose(control[1][at], times, rtol=1e-6)
    inner = np.flatnonzero(np.abs(X).max(axis=1) < (1 - 1e-6) * np.abs(X).max())
    out = []
    for own, other in ((u, control[2][at, :n]), (p, control[3][at, :n])):
        a, b = (v[:, inner] - v[:, inner].mean(axis=1, keepdims=True) for v in (own, other))
        out.append(float(np.linalg.norm(a - b) / np.linalg.norm(b)))
    return out[0], out[1]


def rows(plan: Plan) -> dict[str, dict[str, float]]:
    """All figures by "case method"."""
    agreed, out = study.agreements(plan), {}
    for case in plan.study.cases:
        control: Fields | None = None
        for m in plan.study.methods:
            where = study.Place(case, m.name)
            if where not in agreed:
                continue
            control = fields(plan, study.Place(case, CONTROL)) if control is None else control
            own = fields(plan, where)
            row: dict[str, float] = {}
            if m.solid is not None:
                row["surface u"], row["surface p"] = surface(plan, where, own)
            row["u inside"], row["p inside"] = inside(own, control)
            ds = agreed[where]
            row |= {text: float(ds["nrms"].sel(metric=k)) for k, text in METRICS.items()}
            out[f"{case} {m.name}"] = row
    return out


def table(found: dict[str, dict[str, float]]) -> str:
    """Case, recovery and order in a row; figures with three digits."""
    names = ["surface u", "surface p", "u inside", "p inside", *METRICS.values()]
    lines = [f"| case | recovery | order | {' | '.join(names)} |", "|---" * (3 + len(names)) + "|"]
    for key, row in found.items():
        case, order, recovery = [*key.split(), ""][:3]
        cells = [f"{row[n]:.0e}" if n.startswith("surface") else f"{row[n]:.3f}"[1:] if row[n] < 1 else f"{row[n]:.2f}"
                 for n in names if n in row]  # fmt: skip
        cells = [""] * (len(names) - len(cells)) + cells  # an overlay has no series
        if order == "overlay":
            order, recovery = "", "overlay"
        lines.append(f"| {case} | {recovery} | {order} | {' | '.join(cells)} |")
    return "\n".join(lines)


def plan_of(cases: list[str] | None, methods: list[str] | None, folder: Path | None) -> Plan:
    overrides = []
    for name, values in (("cases", cases), ("methods", methods)):
        overrides += [f"{name}={json.dumps(values)}"] if values else []
    if folder is not None:
        overrides.append(f"folder={json.dumps(str(folder.resolve()))}")
    return study.make_plan(study.read(HERE / "driven.toml", overrides))


def told(done: int, total: int, outcome: Any) -> None:
    print(f"[{done}/{total}] {outcome.label}: {outcome.message or f'{outcome.seconds:.1f} s'}", flush=True)


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--cases", nargs="*")
    ap.add_argument("--methods", nargs="*")
    ap.add_argument("--folder", type=Path, help="where results are kept [default: beside driven.toml]")
    ap.add_argument("--only-print", action="store_true", help="tables of what is done, nothing solved")
    a = ap.parse_args()
    plan = plan_of(a.cases, a.methods, a.folder)
    if not a.only_print:
        study.carry_out(plan, "serial", told)
    print(table(rows(plan)))


if __name__ == "__main__":
    main()

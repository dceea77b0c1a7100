"""Why the mass exchange at 0.1 s is over-predicted at order 2, or not: cases C and D up to the end of the ramp.

    python tests/benchmarks/exchange.py [--cases C D] [--seeds 1 2 3] [--only middle] [--folder exchange.study]

The reduced study with its sampling times to 0.1 s, on tissue meshes with and without the study's 0.2 mm middle element,
steps of the study and shorter ones. Prints a Markdown row for each tissue, case, order and recovery:

- dJ/dt: rate of the volume ratio at the point over the step that ends at 0.1 s, in 1/s; times the cube's volume it
  is what the cube takes in as a whole. An undrained tissue has 0;
- slope: |grad dJ/dt| times half the cube's edge, in 1/s: how much faster one side of the cube is made to grow than its
  middle. Order 2 of the solid has it of F and G (grad J = J F^-T : G); order 1 has none;
- median: of the cells' mass exchange rates, over the control's;
- balance: the same of -rho dV/dt over the last sampling interval, which does not depend on the steps within it;
- error: RMS difference to the control over the cells, over the control's largest rate;
- rho: Spearman's rank correlation with the control over the cells;
- by place: correlation over the cells of the error with -grad dJ/dt . X, X the cell's middle (order 2 of the solid).
  Near 1, the error is what the hand-off's own change of volume drives out on one side of the point and in on the other;
- added: the same correlation of what order 2 adds to order 1 of its recovery.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.stats import spearmanr

from febkit import coupling, study
from febkit.study.plan import CONTROL, Place, Plan
from febkit.study.store import Store
from febkit.study.work import SERIES

REDUCED = Path(__file__).resolve().parents[2] / "examples" / "study_reduced.toml"
METHODS = ["1", "2", "2/1", "1 element", "2 element", "2/1 element", "overlay"]
TIMES = "model.times=[0, 0.01, 0.05, 0.1]"
VARIANTS = {
    "uniform": ["tissue.n=11", "tissue.vertical=41", "tissue.centre=0.0"],
    "middle": ["tissue.n=11", "tissue.vertical=35", "tissue.centre=0.2"],
    "short steps": ["tissue.n=11", "tissue.vertical=41", "tissue.centre=0.0", "model.ramp_step=0.005"],
}


def volume_rates(driving: xr.Dataset) -> tuple[float, np.ndarray]:
    """dJ/dt at the point and its gradient, over the last step."""
    F, G = (driving[k].values[0, -2:] for k in ("F", "G"))
    J = np.linalg.det(F)
    slope = J[:, None] * np.einsum("tji,tijk->tk", np.linalg.inv(F), G)
    dt = float(np.diff(driving["time"].values[-2:])[0])
    return float(np.diff(J)[0] / dt), np.diff(slope, axis=0)[0] / dt


def rows(plan: Plan) -> Iterator[tuple[str, str, str, tuple[float, ...]]]:
    """Case, order, recovery and figures, seeds by their mean."""
    found, store = dict(study.finished(plan)), Store(plan.study.folder)
    for case in plan.study.cases:
        for m in plan.study.methods:
            each = []
            rate, slope = np.nan, np.full(3, np.nan)
            model = plan.metrics[Place(case, m.name)].inputs["model"]
            if "series" in model.inputs and store.has(model.inputs["series"].key):
                rate, slope = volume_rates(coupling.read_driving(store.path(model.inputs["series"].key) / SERIES))
                slope = slope if m.solid == 2 else np.zeros(3)
            for place in [p for p in found if p.case == case and p.method == m.name]:
                control, own = (found[p].isel(time=-1) for p in (place._replace(method=CONTROL), place))
                a, b = (ds["mass_exchange_rate"].values for ds in (control, own))
                lost = float(own["volume_loss_rate"].median() / control["volume_loss_rate"].median())
                rho = float(spearmanr(a, b)[0])
                error = float(np.sqrt(np.mean((b - a) ** 2)) / np.abs(a).max())
                x = found[place]["centroid"].isel(time=0).values @ -slope
                along = float(np.corrcoef(b - a, x)[0, 1]) if np.ptp(x) > 0 else np.nan
                first = found.get(place._replace(method=f"1{m.name[len(m.name.partition(' ')[0]) :]}"))
                added = np.nan
                if first is not None and np.ptp(x) > 0:
                    added = float(np.corrcoef(b - first["mass_exchange_rate"].isel(time=-1).values, x)[0, 1])
                each.append((float(np.median(b) / np.median(a)), lost, error, rho, along, added))
            if not each:
                continue
            order, _, recovery = m.name.partition(" ")
            rates = (rate, float(np.linalg.norm(slope)) * 0.1 / 2)
            yield case, order, recovery or ("" if order == "overlay" else "patches"), (*rates, *np.mean(each, axis=0))


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--cases", nargs="*", default=["C", "D"])
    ap.add_argument("--seeds", nargs="*", type=int, default=[1])
    ap.add_argument("--only", nargs="*", choices=list(VARIANTS), default=list(VARIANTS))
    ap.add_argument("--methods", nargs="*", default=METHODS)
    ap.add_argument("--folder", type=Path, default=Path("exchange.study"))
    ap.add_argument("--scheduler", default="serial")
    ap.add_argument("--only-print", action="store_true", help="the table of what is done, nothing solved")
    a = ap.parse_args()
    shared = [f"cases={json.dumps(a.cases)}", f"methods={json.dumps(a.methods)}", TIMES, f"cell.seed={a.seeds}",
              f"folder={json.dumps(str(a.folder.resolve()))}"]  # fmt: skip
    head = ["tissue", "case", "recovery", "order", "dJ/dt", "slope", "median", "balance", "error", "rho", "by place"]
    head.append("added")
    print(f"| {' | '.join(head)} |\n" + "|---" * len(head) + "|")
    for name in a.only:
        plan = study.make_plan(study.read(REDUCED, [*shared, *VARIANTS[name]]))
        if not a.only_print:
            for o in study.carry_out(plan, a.scheduler).failed:
                print(o.label, o.message)
        for case, order, recovery, v in rows(plan):
            text = " | ".join("" if np.isnan(x) else f"{x:.3f}" if k < 2 else f"{x:.2f}" for k, x in enumerate(v))
            print(f"| {name} | {case} | {recovery} | {order} | {text} |", flush=True)


if __name__ == "__main__":
    main()

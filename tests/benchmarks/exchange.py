"""Why the mass exchange at 0.1 s is over-predicted at order 2, or not: cases C and D up to the end of the ramp.

    python tests/benchmarks/exchange.py [--cases C D] [--seeds 1 2 3] [--only middle] [--folder exchange.study]

The reduced study with its sampling times to 0.1 s, on tissue meshes with and without the study's 0.2 mm middle element,
steps of the study and shorter ones. Prints a Markdown row for each tissue, case, order and recovery:

- dJ/dt: rate of the volume ratio at the point over the step that ends at 0.1 s, in 1/s; times the cube's volume it
  is what the cube takes in as a whole. An undrained tissue has 0;
- slope: |grad dJ/dt| times half the cube's edge, in 1/s: how much faster one side of the cube is made to grow than its
  middle. Order 2 of the solid has it of F and G (grad J = J F^-T : G); order 1 has none;
- median: of the cells' mass exchange rates, over the control's;
- error: RMS difference to the control over the cells, over the control's largest rate;
- rho: Spearman's rank correlation with the control over the cells.
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
    "fine, middle": ["tissue.n=21", "tissue.vertical=35", "tissue.centre=0.2"],
    "short steps": ["tissue.n=11", "tissue.vertical=41", "tissue.centre=0.0", "model.ramp_step=0.005"],
}


def volume_rates(driving: xr.Dataset, edge: float) -> tuple[float, float]:
    """dJ/dt at the point, and |grad dJ/dt| times half the edge, over the last step."""
    F, G = (driving[k].values[0, -2:] for k in ("F", "G"))
    J = np.linalg.det(F)
    slope = J[:, None] * np.einsum("tji,tijk->tk", np.linalg.inv(F), G)
    dt = float(np.diff(driving["time"].values[-2:])[0])
    return float(np.diff(J)[0] / dt), float(np.linalg.norm(np.diff(slope, axis=0)) / dt * edge / 2)


def rows(plan: Plan) -> Iterator[tuple[str, str, str, tuple[float, ...]]]:
    """Case, order, recovery and figures, seeds by their mean."""
    found, store = dict(study.finished(plan)), Store(plan.study.folder)
    for case in plan.study.cases:
        for m in plan.study.methods:
            each = []
            for place in [p for p in found if p.case == case and p.method == m.name]:
                pair = (place._replace(method=CONTROL), place)
                a, b = (found[p]["mass_exchange_rate"].isel(time=-1).values for p in pair)
                rho = float(spearmanr(a, b)[0])
                error = float(np.sqrt(np.mean((b - a) ** 2)) / np.abs(a).max())
                each.append((float(np.median(b) / np.median(a)), error, rho))
            if not each:
                continue
            rates = (np.nan, np.nan)
            model = plan.metrics[Place(case, m.name)].inputs["model"]
            if "series" in model.inputs:
                driving = coupling.read_driving(store.path(model.inputs["series"].key) / SERIES)
                rate, slope = volume_rates(driving, 0.1)
                rates = (rate, slope if m.solid == 2 else 0.0)
            order, _, recovery = m.name.partition(" ")
            yield case, order, recovery or ("" if order == "overlay" else "patches"), (*rates, *np.mean(each, axis=0))


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--cases", nargs="*", default=["C", "D"])
    ap.add_argument("--seeds", nargs="*", type=int, default=[1])
    ap.add_argument("--only", nargs="*", choices=list(VARIANTS), default=list(VARIANTS))
    ap.add_argument("--methods", nargs="*", default=METHODS)
    ap.add_argument("--folder", type=Path, default=Path("exchange.study"))
    ap.add_argument("--scheduler", default="serial")
    a = ap.parse_args()
    shared = [f"cases={json.dumps(a.cases)}", f"methods={json.dumps(a.methods)}", TIMES, f"cell.seed={a.seeds}",
              f"folder={json.dumps(str(a.folder.resolve()))}"]  # fmt: skip
    print("| tissue | case | recovery | order | dJ/dt | slope | median | error | rho |\n" + "|---" * 9 + "|")
    for name in a.only:
        plan = study.make_plan(study.read(REDUCED, [*shared, *VARIANTS[name]]))
        summary = study.carry_out(plan, a.scheduler)
        for o in summary.failed:
            print(o.label, o.message)
        for case, order, recovery, v in rows(plan):
            text = " | ".join("" if np.isnan(x) else f"{x:.3f}" if k < 2 else f"{x:.2f}" for k, x in enumerate(v))
            print(f"| {name} | {case} | {recovery} | {order} | {text} |", flush=True)


if __name__ == "__main__":
    main()

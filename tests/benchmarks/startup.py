"""What starting costs: help, one-element models with and without the extension, of few and of many steps; a suite.

    python tests/benchmarks/startup.py [--repeat 5] [--cold] [--suite FOLDER]

--cold also runs with an empty kernel cache; --suite runs FOLDER/models/*.feb one after the other and adds up seconds
beside FEBio's in FOLDER/reference/index.json, over the models that febkit solves.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

NODES = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
MODEL = f"""<?xml version="1.0"?>
<febio_spec version="4.0">
<Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>10</time_steps><step_size>0.1</step_size></Control>
<Material><material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material></Material>
<Mesh>
<Nodes name="all">{"".join(f'<node id="{i + 1}">{x},{y},{z}</node>' for i, (x, y, z) in enumerate(NODES))}</Nodes>
<Elements type="hex8" name="cube"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<NodeSet name="bottom">1,2,3,4</NodeSet><NodeSet name="top">5,6,7,8</NodeSet>
</Mesh>
<MeshDomains><SolidDomain name="cube" mat="m"/></MeshDomains>
<Boundary>
<bc type="zero displacement" node_set="bottom"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc type="prescribed displacement" node_set="top"><dof>z</dof><value lc="1">0.2</value><relative>0</relative></bc>
</Boundary>
<LoadData><load_controller id="1" type="loadcurve">
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>
<Output><plotfile type="febio"><var type="displacement"/><var type="stress"/></plotfile></Output>
</febio_spec>
"""

# one element of an artery's wall, stretched twice and let go over 204 steps, three iterations each
STRETCHED = (
    MODEL.replace("<time_steps>10</time_steps><step_size>0.1</step_size>", f"""
<time_steps>204</time_steps><step_size>{1 / 204}</step_size>
<solver type="solid"><dtol>1e-5</dtol><etol>1e-4</etol></solver>""")
    .replace('type="neo-Hookean"><E>1</E><v>0.3</v>', """type="Holzapfel-Gasser-Ogden">
<c>7.64</c><k1>996.6</k1><k2>524.6</k2><kappa>0.226</kappa><gamma>49.98</gamma><k>7640</k>""")
    .replace("<pt>0,0</pt><pt>1,1</pt>", "<pt>0,0</pt><pt>.25,1</pt><pt>.5,0</pt><pt>.75,1</pt><pt>1,0</pt>")
    .replace("0.2</value>", "0.1</value>")
)


def seconds(args: list[str], environment: dict[str, str] | None = None) -> tuple[float, float, int]:
    """Wall seconds, processor seconds and exit code of one process."""
    start = time.perf_counter()
    p = subprocess.Popen(args, env={**os.environ, **(environment or {})}, stdout=subprocess.DEVNULL,
                         stderr=subprocess.DEVNULL)
    _, status, use = os.wait4(p.pid, 0)
    p.returncode = os.waitstatus_to_exitcode(status)
    return time.perf_counter() - start, use.ru_utime + use.ru_stime, p.returncode


def best(args: list[str], repeat: int, environment: dict[str, str] | None = None) -> tuple[float, float]:
    """Least wall and processor seconds of several runs."""
    runs = [seconds(args, environment) for _ in range(repeat)]
    assert all(code == 0 for _, _, code in runs), f"{args} failed"
    return min(r[0] for r in runs), min(r[1] for r in runs)


def line(name: str, wall: float, processor: float) -> None:
    print(f"| {name} | {wall:.2f} s | {processor:.2f} s |", flush=True)


def table(repeat: int, cold: bool) -> None:
    febkit = [sys.executable, "-m", "febkit.cli.main"]
    print("| | wall | processor |\n|---|---|---|")
    line("bare interpreter", *best([sys.executable, "-c", ""], repeat))
    line("with numpy", *best([sys.executable, "-c", "import numpy"], repeat))
    line("febkit --help", *best([*febkit, "--help"], repeat))
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "one.feb"
        model.write_text(MODEL)
        run = [*febkit, "run", str(model), "-silent"]
        if cold:
            once = seconds(run, {"FEBKIT_CACHE": str(Path(folder) / "empty")})
            line("one element, empty kernel cache", *once[:2])
        seconds(run)
        line("one element", *best(run, repeat))
        line("one element, kernels called by ctypes", *best(run, repeat, {"FEBKIT_NATIVE": "0"}))
        model.write_text(STRETCHED)
        seconds(run)
        line("one element over 204 steps", *best(run, repeat))


def suite(folder: Path) -> None:
    """Every model twice, the second time counted: the first one may compile."""
    index = json.loads((folder / "reference" / "index.json").read_text())
    total = [0.0, 0.0, 0.0]
    count = 0
    with tempfile.TemporaryDirectory() as out:
        for model in sorted((folder / "models").glob("*.feb")):
            run = [sys.executable, "-m", "febkit.cli.main", "run", str(model), "-p", f"{out}/m.xplt", "-o",
                   f"{out}/m.log", "-silent"]
            if model.stem not in index or seconds(run)[2]:
                continue
            wall, processor, _ = seconds(run)
            count += 1
            febio = index[model.stem]["seconds"]
            total = [a + b for a, b in zip(total, (wall, processor, febio))]
            print(f"{model.stem:12s} {wall:8.2f} s, processor {processor:8.2f} s, FEBio {febio:8.2f} s", flush=True)
    print(f"{count} models: {total[0]:.1f} s, processor {total[1]:.1f} s, FEBio {total[2]:.1f} s")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--cold", action="store_true")
    parser.add_argument("--suite", type=Path)
    asked = parser.parse_args()
    table(asked.repeat, asked.cold)
    if asked.suite:
        suite(asked.suite)

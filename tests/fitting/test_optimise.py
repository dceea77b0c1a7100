"""FEBio's optimisation files: what they may say, what is refused and why, and the truth found by each objective."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit.fitting import febio, optimise
from febkit.model import InputError
from helpers import cube
from helpers.command import febkit as command

SOLID = '<material id="1" name="m" type="neo-Hookean"><density>1</density><E>{E}</E><v>0.3</v></material>'
RIGID = ('<material id="2" name="lid" type="rigid body"><density>1</density><center_of_mass>0,0,0</center_of_mass>'
         "</material>")  # fmt: skip
MORE = """<Rigid>
<rigid_bc type="rigid_fixed"><rb>lid</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof>
<Rw_dof>1</Rw_dof></rigid_bc>
<rigid_bc type="rigid_displacement"><rb>lid</rb><dof>z</dof><value lc="1">{pull}</value></rigid_bc></Rigid>
<LoadData><load_controller id="1" name="ramp" type="loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points>
</load_controller></LoadData>"""
CONTROL = "<time_steps>4</time_steps><step_size>0.25</step_size>"


def deck(E: float, pull: float = 0.2) -> str:
    text = cube.text(SOLID.format(E=E) + RIGID, control=CONTROL, more=MORE.format(pull=pull))
    held = '<bc node_set="top" type="rigid"><rb>lid</rb></bc></Boundary>'
    names = '</NodeSet><ElementSet name="all">1</ElementSet></Mesh>'
    return text.replace("</Boundary>", held).replace("</NodeSet>\n</Mesh>", names)


STIFFNESS = """<param name="fem.material('m').E">1, 0.2, 9</param>"""


def optimisation(
    objective: str, kind: str = "levmar", options: str = "", parameters: str = STIFFNESS, more: str = ""
) -> str:
    return f"""<?xml version="1.0"?>
<febio_optimize version="2.0">
<Options type="{kind}"><obj_tol>1e-6</obj_tol>{options}</Options>
<Parameters>
{parameters}
</Parameters>
{more}
{objective}
</febio_optimize>
"""


def objective(kind: str, *lines: str) -> str:
    return f'<Objective type="{kind}">\n' + "\n".join(lines) + "\n</Objective>"


def measured(probe: str) -> tuple[list[float], list[float]]:
    """What a probe shows of the true model (E = 3), at its steps."""
    at = objective("data-fit", f'<fnc type="parameter"><param name="{probe}"/></fnc>', "<data><p>0,0</p></data>")
    folder = FOLDER[0]
    (folder / "probe.feb").write_text(optimisation(at))
    file = optimise.read(folder / "probe.feb")
    (e,) = febio.posed(file, febkit.read(folder / "true.feb"), threads=1).experiments
    rows, _ = e.rows({})  # type: ignore[attr-defined]
    return rows[:, 0].tolist(), rows[:, 1].tolist()


FOLDER: list[Path] = []


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    d = tmp_path_factory.mktemp("optimise")
    FOLDER[:] = [d]
    (d / "true.feb").write_text(deck(3.0))
    (d / "m.feb").write_text(deck(0.7))
    return d


def fit(folder: Path, text: str) -> febkit.fitting.Fit:  # type: ignore[name-defined]
    (folder / "o.feb").write_text(text)
    return febio.fit(folder / "o.feb", febkit.read(folder / "m.feb"), threads=1)


PROBES = [
    "fem.rigidbody('lid').Fz", "fem.rigidbody[0].Fz", "fem.element_data('sz', 1)", "fem.node_data('Rz', 1)",
    "fem.domain_data(avg('sz'), 'cube')",
]  # fmt: skip


@pytest.mark.parametrize("probe", PROBES)
def test_curves_of_each_kind_give_the_truth(folder: Path, probe: str) -> None:
    t, y = measured(probe)
    assert t == [0.0, 0.25, 0.5, 0.75, 1.0] and y[0] == 0.0 and np.abs(y[1:]).min() > 1e-3
    points = "".join(f"<point>{a},{b!r}</point>" for a, b in zip(t, y))
    f = fit(folder, optimisation(objective("data-fit", f'<fnc type="parameter"><param name="{probe}"/></fnc>',
                                           f"<data>{points}</data>")))  # fmt: skip
    assert f.converged and f.values == {"fem.material('m').E": pytest.approx(3.0, rel=1e-4)} and f.runs <= 4


def test_what_moves_is_followed_too(folder: Path) -> None:
    t = np.linspace(0.0, 1.0, 5)
    known = {
        "fem.time": t, "fem.rigidbody('lid').position.z": 0.2 * t, "fem.mesh.node[4].position.z": 1 + 0.2 * t,
        "fem.mesh.node.fromId(5).z": 0.2 * t, "fem.node_data('uz', 5)": 0.2 * t, "fem.material('m').v": 0.3 + 0 * t,
    }  # fmt: skip
    for probe, values in known.items():
        assert measured(probe)[1] == pytest.approx(values, abs=1e-12), probe


@pytest.mark.parametrize("way", ["ordinate", "import", "sum", "size", "element-data", "node-data", "target", "mean"])
def test_objectives_of_each_kind_give_the_truth(folder: Path, way: str) -> None:
    t, s = measured("fem.element_data('sz', 1)")
    _, strain = measured("fem.element_data('Ez', 1)")
    _, R = measured("fem.node_data('Rz', 1)")
    points = "".join(f"<point>{a},{b!r}</point>" for a, b in zip(t, s))
    total = "".join(f"<point>{a},{abs(4 * b)!r}</point>" for a, b in zip(t, R))
    (folder / "curve.txt").write_text("".join(f"{a} {b!r}\n" for a, b in zip(t, s)) + "end\n7 7\n")
    stress = '<param name="fem.element_data(\'sz\', 1)"/>'
    over = '<ordinate name="fem.element_data(\'Ez\', 1)"/>'
    said = {
        "ordinate": objective("data-fit", f'<fnc type="parameter">{over}{stress}</fnc>',
                              "<data>" + "".join(f"<point>{a!r},{b!r}</point>" for a, b in zip(strain, s)) + "</data>"),
        "import": objective("data-fit", f'<fnc type="parameter">{stress}</fnc>', '<data import="curve.txt"/>'),
        "sum": objective("data-fit", '<fnc type="filter_sum"><element_data data="=sz+0*sx" elem_set="all"/></fnc>',
                         f"<data>{points}</data>"),
        "size": objective("data-fit", '<fnc type="filter_positive_only"><source type="filter_sum">'
                          '<node_data data="Rz" node_set="base"/></source></fnc>', f"<data>{total}</data>"),
        "element-data": objective("element-data", '<var type="sz"/>', f'<data><elem id="1">{s[-1]!r}</elem></data>'),
        "node-data": objective("node-data", '<var type="Rz;uz"/>', f'<data><node id="1">{R[-1]!r},0</node></data>'),
        "target": objective("target", f'<var name="fem.rigidbody(\'lid\').Fz">{-4 * R[-1]!r}</var>'),
        "mean": objective("target", '<fnc type="filter_avg"><elem_data data="sz" elem_set="all"/>',
                          f"<target>{s[-1]!r}</target></fnc>"),
    }  # fmt: skip
    f = fit(folder, optimisation(said[way]))
    assert f.converged and f["fem.material('m').E"] == pytest.approx(3.0, rel=1e-4)


TARGET = objective("target", "<var name=\"fem.element_data('sz', 1)\">0.8</var>")


def test_methods_and_constraints(folder: Path) -> None:
    both = """<param name="m.E">1, 0.2, 9, 2</param>
<param name="fem.load_controller('ramp').points[1].y">0.7, 0.5, 1.5</param>"""
    f = fit(folder, optimisation(TARGET, kind="constrained levmar", parameters=both,
                                 more="<Constraints><constraint>1,-2,0.5</constraint></Constraints>"))  # fmt: skip
    E, y = f.values.values()
    assert f.converged and f.objective < 1e-8 and pytest.approx(0.5, abs=1e-9) == E - 2 * y
    alone = optimisation(TARGET, kind="powell").replace("<obj_tol>1e-6</obj_tol>", "")
    assert fit(folder, alone).objective < 1e-4
    grid = fit(folder, alone.replace("powell", "scan").replace("1, 0.2, 9", "1, 1, 5, 0.5"))
    assert grid.runs == 9 and abs(grid["fem.material('m').E"] - E_of(folder)) < 0.26


def E_of(folder: Path) -> float:
    return fit(folder, optimisation(TARGET))["fem.material('m').E"]


@pytest.mark.parametrize(
    ("old", "new", "line", "why"),
    [
        ("<febio_optimize version", "<febio_spec version", 2, "no optimisation file"),
        ('version="2.0"', 'version="1.0"', 2, "none of 2.0, 2.5, 3.0, 4.0"),
        ('type="levmar"', 'type="genetic"', 3, "none of levmar, constrained levmar, powell, scan"),
        ("<obj_tol>1e-6</obj_tol>", "<obj_tol>0</obj_tol>", 3, "must be above 0"),
        ("<Options", '<Task type="optimize"/><Options', 3, "the task is a text, <Task>solve</Task>"),
        ("<obj_tol>1e-6</obj_tol>", "<tau>1</tau>", 3, "<tau> is not known in <Options>; it may have obj_tol"),
        ("<obj_tol>1e-6</obj_tol>", "<print_level>LOUD</print_level>", 3, "PRINT_VERBOSE"),
        ("1, 0.2, 9", "1, 0.2", 5, "3 to 4 numbers"),
        ("1, 0.2, 9", "1, 2, 9", 5, "min <= initial <= max"),
        ("fem.material('m').E", "fem.material('bone').E", 5, 'no material "bone"; there are m, lid'),
        ("fem.material('m').E", "fem.material('m').type", 5, "no parameter 'type'"),
        ('type="target"', 'type="aim"', 8, "none of data-fit, target, element-data, node-data"),
        (">0.8<", ">much<", 9, "must be 1 numbers"),
        ("fem.element_data('sz', 1)", "fem.element_data('szz', 1)", 9, "not computed by febkit"),
        ("fem.element_data('sz', 1)", "fem.element_data('sz', 7)", 9, "7, which does not exist"),
        ("fem.element_data('sz', 1)", "fem.rigidbody('m').Fz", 9, "there is no such rigid body; there are lid"),
        ("fem.element_data('sz', 1)", "fem.rigidbody('lid').Q", 9, "can be followed"),
        ("fem.element_data('sz', 1)", "fem.bone", 9, "no global variable"),
        ("<var name", "<vat name", 9, "<vat> is not known in <Objective>"),
    ],
)  # fmt: skip
def test_what_is_refused_says_where_and_why(folder: Path, old: str, new: str, line: int, why: str) -> None:
    text = optimisation(TARGET)
    assert old in text
    text = text.replace(old, new).replace("</var>", "</vat>" if "vat" in new else "</var>")
    text = text.replace("</febio_optimize>", "</febio_spec>") if "spec" in new else text
    with pytest.raises(InputError) as e:
        fit(folder, text)
    assert why in str(e.value) and e.value.where is not None and e.value.where.line == line, e.value


LOUD = "<print_level>PRINT_VERBOSE</print_level>"
LAYOUT = (
    "----- Iteration: 1 -----", "CURRENT        REQUIRED      DIFFERENCE", "regression coef: 1",
    "Total iterations ........ :", "Final objective value ... :", "N O R M A L   T E R M I N A T I O N",
)  # fmt: skip


def test_the_command_and_its_log(folder: Path) -> None:
    t, y = measured("fem.rigidbody('lid').Fz")
    points = "".join(f"<point>{a},{b!r}</point>" for a, b in zip(t, y))
    force = "<fnc type=\"parameter\"><param name=\"fem.rigidbody('lid').Fz\"/></fnc>"
    text = optimisation(objective("data-fit", force, f"<data>{points}</data>"), options=LOUD)
    (folder / "o.feb").write_text(text)
    done = command("fit", "o.feb", "m.feb", "-w", "fitted.feb", "-d", "fit.csv", "-p", "fit.png", folder=folder)
    assert done.returncode == 0 and "R^2 = 1" in done.stdout, done.stderr
    log = (folder / "o.log").read_text()
    for words in LAYOUT:
        assert words in log
    final = float(log.split("Optimal parameters:")[1].split("=")[1].split()[0])
    assert final == pytest.approx(3.0, rel=1e-4)
    assert febkit.read(folder / "fitted.feb")["m.E"] == pytest.approx(final)
    assert len((folder / "fit.csv").read_text().splitlines()) == 6 and (folder / "fit.png").stat().st_size > 5000
    same = command("-i", "m.feb", "-s", "o.feb", "-silent", folder=folder)  # FEBio's command line
    assert same.returncode == 0 and not same.stdout and "Optimal parameters" in (folder / "o.log").read_text()

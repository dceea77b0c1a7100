"""Logs and data files in FEBio's layout."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from febkit.model import InputError
from febkit.results.log import read_log
from febkit.results.records import open_data, read_data

STEP = """
===== beginning time step {n} : {t} =====
Reforming stiffness matrix: reformation #1

 1
 Nonlinear solution status: time= {t}
\tstiffness updates             = 0
\tright hand side evaluations   = 2
\tstiffness matrix reformations = 1
\tstep from line search         = 1.000000
\tconvergence norms :     INITIAL         CURRENT         REQUIRED
\t   residual            1.000000e+00    2.500000e-01    0.000000e+00
\t   energy              4.000000e-02    1.000000e-05    4.000000e-04
\t   displacement        3.000000e-03    3.000000e-03    3.000000e-09
\t   fluid pressure      7.000000e-02    1.000000e-08    7.000000e-08
 2
 Nonlinear solution status: time= {t}
\tstiffness updates             = 1
\tright hand side evaluations   = 3
\tstiffness matrix reformations = 1
\tstep from line search         = 0.500000
\tconvergence norms :     INITIAL         CURRENT         REQUIRED
\t   residual            1.000000e+00    1.250000e-09    0.000000e+00
\t   energy              4.000000e-02    1.000000e-12    4.000000e-04
\t   displacement        3.000000e-03    -nan    3.000000e-09
\t   fluid pressure      7.000000e-02    1.000000e-11    7.000000e-08

convergence summary
    number of iterations   : 2
    number of reformations : 1

------- {end} at time : {t}

"""
WARNING = """ *************************************************************************
 *                                WARNING                                *
 *                                                                       *
 * No force acting on the system.                                        *
 * Second line.                                                          *
 *************************************************************************
"""
ERROR = WARNING.replace("WARNING", " ERROR ").replace("No force acting on the system.", "Negative jacobian    ")
RECORD = """
Data Record #1
===========================================================================
Step = 1
Time = 0.1
Data = x;y
1 0.25 -1e-3
7 0.5 2.5
"""
END = """

 N O N L I N E A R   I T E R A T I O N   S U M M A R Y

\tNumber of time steps completed .................... : 1

\tTotal number of equilibrium iterations ............ : 4

 Elapsed time : 0:00:01

 T I M I N G   I N F O R M A T I O N

\tSolve time ...................... : 0:00:02 (1.75 sec)

 {how} T E R M I N A T I O N

"""
NORMAL, BAD = "N O R M A L  ", "E R R O R  "


@pytest.fixture
def log(tmp_path: Path) -> Path:
    text = (STEP.format(n=1, t=0.1, end="converged") + RECORD + WARNING
            + STEP.format(n=2, t=0.2, end="failed to converge") + ERROR + END.format(how=BAD))
    path = tmp_path / "run.log"
    path.write_text(text)
    return path


def test_convergence_history(log: Path) -> None:
    r = read_log(log)
    assert r.steps.to_dict("list") == {
        "step": [1, 2], "time": [0.1, 0.2], "converged": [True, False], "iterations": [2, 2], "reformations": [1, 1],
    }
    it = r.iterations
    assert it[["step", "iteration"]].to_numpy().tolist() == [[1, 1], [1, 2], [2, 1], [2, 2]]
    assert it["residual"].tolist() == [0.25, 1.25e-9] * 2
    assert it["fluid_pressure_required"].tolist() == [7e-8] * 4
    assert it["energy_initial"][0] == 0.04
    assert np.isnan(it["displacement"][1])
    assert it["line_search"].tolist() == [1.0, 0.5] * 2
    assert it["residuals"].tolist() == [2, 3] * 2


def test_messages_records_and_end(log: Path) -> None:
    r = read_log(log)
    assert [m.text for m in r.warnings] == ["No force acting on the system. Second line."]
    assert [m.text for m in r.errors] == ["Negative jacobian Second line."]
    assert log.read_text().splitlines()[r.errors[0].line - 1].startswith(" ****")
    assert r.normal is False
    assert r.summary["Solve time"] == 1.75
    assert r.summary["Total number of equilibrium iterations"] == 4
    (record,) = r.records
    assert (record.step, record.time, record.names) == (1, 0.1, ["x", "y"])
    np.testing.assert_array_equal(record.items, [1, 7])
    np.testing.assert_array_equal(record.values, [[0.25, -1e-3], [0.5, 2.5]])


def test_log_that_is_still_written(log: Path) -> None:
    text = log.read_text()
    for cut in range(0, len(text), 97):
        log.write_text(text[:cut])
        r = read_log(log)
        assert r.normal is None or cut > len(text) - 20
        assert len(r.steps) <= 2
    log.write_text(END.format(how=NORMAL))
    assert read_log(log).normal is True


def test_missing_log(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot read the log"):
        read_log(tmp_path / "none.log")


def blocks(delim: str) -> str:
    out = ""
    for n, t in ((1, 0.1), (2, 0.2)):
        out += f"*Step  = {n}\n*Time  = {t}\n*Data  = ux;uy\n"
        out += "".join(f"{i}{delim}{i * t:g}{delim}{-i * t:g}\n" for i in (3, 8))
    return out


@pytest.mark.parametrize("delim", [" ", ",", ", ", "\t"])
def test_data_file(tmp_path: Path, delim: str) -> None:
    path = tmp_path / "disp.txt"
    path.write_text(blocks(delim))
    table = read_data(path)
    assert isinstance(table, pd.DataFrame)
    assert table["item"].tolist() == [3, 8, 3, 8]
    assert table["time"].tolist() == [0.1, 0.1, 0.2, 0.2]
    np.testing.assert_allclose(table["ux"], [0.3, 0.8, 0.6, 1.6])
    ds = open_data(path)
    assert ds["uy"].dims == ("time", "item")
    np.testing.assert_allclose(ds["uy"].sel(item=8), [-0.8, -1.6])


def test_data_file_without_comments(tmp_path: Path) -> None:
    path = tmp_path / "disp.txt"
    path.write_text("".join(line + "\n" for line in blocks(" ").splitlines() if not line.startswith("*")))
    table = read_data(path)
    assert table["step"].tolist() == [1, 1, 2, 2]
    np.testing.assert_allclose(table["value1"], [0.3, 0.8, 0.6, 1.6])
    assert open_data(path)["value2"].shape == (2, 2)


def test_ragged_data_file(tmp_path: Path) -> None:
    path = tmp_path / "disp.txt"
    path.write_text(blocks(" ") + "9 1\n")
    with pytest.raises(InputError, match=r"disp.txt:9.*differ in length"):
        read_data(path)
    path.write_text("1 two three\n")
    with pytest.raises(InputError, match="not a row of numbers"):
        read_data(path)


def test_counts_that_are_no_numbers(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    text = STEP.format(n=1, t=0.1, end="converged")
    path.write_text(text.replace("stiffness matrix reformations = 1", "stiffness matrix reformations = inf"))
    log = read_log(path)
    assert log.steps["reformations"].tolist() == [0] and len(log.iterations) == 2
    path.write_text(text + "I T E R A T I O N   S U M M A R Y\n Time : " + ":".join("1" * 180) + "\n")
    assert not read_log(path).summary


@pytest.mark.parametrize("line", [" a" + " " * 4000, " a" + "." * 4000, " " + "a " * 2000, " a " + "1" * 4000])
def test_long_lines_take_no_time(tmp_path: Path, line: str) -> None:
    """A line that fits no pattern must not be tried in every way of cutting it."""
    import time

    path = tmp_path / "a.log"
    short = line[:390] + "\n"
    path.write_text(STEP.format(n=1, t=0.1, end="converged") + short * 50 + line * 50
                    + "\nI T E R A T I O N   S U M M A R Y\n" + short * 50 + line * 50)  # fmt: skip
    start = time.process_time()
    assert len(read_log(path).iterations) == 2
    assert time.process_time() - start < 0.5


def test_ids_of_a_data_file_are_numbers_of_items(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("*Step = 1\n1e300 2\n")
    with pytest.raises(InputError, match="number of an item"):
        read_data(path)

"""Properties over depth: what a profile gives, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from febkit.model import InputError, Where
from febkit.templates.parameters import Parameter, declared
from febkit.templates.profile import profile

D = np.array([0.0, 0.1, 0.5, 0.9, 1.0])


def modulus(**bounds: float) -> Parameter:
    table = {"default": 1.0, "doc": "Young's modulus of the test", "kind": "field", "above": 0.0, **bounds}
    return declared("E", table, Where("template.toml"))


@pytest.mark.parametrize(("value", "expected"), [
    (2.0, [2, 2, 2, 2, 2]),
    ([[0.1, 1.0], [0.9, 3.0]], [1, 1, 2, 3, 3]),  # level beyond the rows
    ({"points": [[0.0, 1.0], [0.5, 4.0]], "rule": "steps"}, [1, 1, 4, 4, 4]),
    ([[0.3, 7.0]], [7, 7, 7, 7, 7]),
])
def test_values_over_depth(value: Any, expected: list[float]) -> None:
    assert np.allclose(profile("E", value).at(D), expected)


def test_splines_meet_their_rows_and_the_function_they_are_of() -> None:
    d = np.linspace(0.0, 1.0, 11)
    f = lambda x: 2.0 + np.sin(np.pi * x)  # noqa: E731
    rows = np.column_stack([d, f(d)]).tolist()
    x = np.linspace(0.0, 1.0, 173)
    cubic, monotone, line = (profile("E", {"points": rows, "rule": r}) for r in ("cubic", "monotone", "linear"))
    for p in (cubic, monotone, line):
        assert np.allclose(p.at(d), f(d))
    errors = [float(np.abs(p.at(x) - f(x)).max()) for p in (cubic, monotone, line)]
    assert errors[0] < errors[1] / 5 < errors[2] / 5
    # of natural splines of a function whose second derivative is 0 at both ends: 5/384 h^4 max|d4f|
    assert errors[0] < 5 / 384 * 0.1**4 * np.pi**4


def test_a_monotone_spline_stays_between_its_rows_where_a_cubic_one_does_not() -> None:
    rows = [[0.0, 1.0], [0.4, 1.0], [0.5, 9.0], [1.0, 9.0]]
    x = np.linspace(0.0, 1.0, 201)
    cubic, monotone = (profile("E", {"points": rows, "rule": r}).at(x) for r in ("cubic", "monotone"))
    assert monotone.min() >= 1.0 and monotone.max() <= 9.0
    assert cubic.min() < 0.0
    with pytest.raises(InputError, match="monotone"):  # below 0 between rows that are above it
        modulus().checked({"points": rows, "rule": "cubic"})
    assert modulus().checked({"points": rows, "rule": "monotone"}).rule == "monotone"


@pytest.mark.parametrize("text", [
    "depth,E\n0,1\n1,3\n", "0 1\n1 3\n", "E;depth\n1;0\n3;1\n",
    "\ufeff# measured\ndepth, v, E\n0, 0.1, 1\n\n1, 0.2, 3\n",
    "0\t1\r\n1\t3\r\n",
])
def test_csv_files(tmp_path: Path, text: str) -> None:
    (tmp_path / "E.csv").write_text(text, encoding="utf-8", newline="")
    p = modulus().checked("E.csv", Where(str(tmp_path / "p.toml")))  # relative to the file that names it
    assert (p.depths, p.values, p.file) == ((0.0, 1.0), (1.0, 3.0), str(tmp_path / "E.csv"))


def test_a_column_of_a_csv_file(tmp_path: Path) -> None:
    (tmp_path / "all.csv").write_text("depth,soft,stiff\n0,1,5\n1,2,6\n")
    where = Where(str(tmp_path / "p.toml"))
    p = modulus().checked({"file": "all.csv", "column": "stiff", "rule": "steps"}, where)
    assert (p.values, p.rule) == ((5.0, 6.0), "steps")
    with pytest.raises(InputError, match="no column 'E'; its columns are depth, soft, stiff"):
        modulus().checked("all.csv", where)


@pytest.mark.parametrize(("value", "words"), [
    ([[0.0, 1.0], [0.0, 2.0]], "depths must rise.*0 follows 0: sort the rows"),
    ([[0.0, 1.0], [1.5, 2.0]], "depth 1.5 is outside 0 .*: divide depths by the thickness"),
    ([[-0.1, 1.0]], "outside 0"),
    ([[0.0, 1.0, 2.0]], r"row 1 must be two numbers, \[depth, value\]"),
    ([[0.0, float("nan")]], "finite number, not nan"),
    ([[0.0, True]], "finite number, not True"),
    ([[0.0, 1.0], [1.0, 0.0]], r"greater than 0, not 0 \(at depth 1\)"),
    ([1.0, [0.5, 2.0]], "row 1 must be two numbers"),
    ([], "E must be a number, one number for each zone"),
    ({"rule": "cubic"}, "needs either points or file"),
    ({"points": [[0, 1]], "file": "a.csv"}, "needs either points or file"),
    ({"points": [[0, 1]], "colour": 1}, "no entry 'colour'"),
    ({"points": [[0, 1]], "rule": "wavy"}, "one of linear, cubic, monotone, steps"),
    ({"file": 3}, "path of a CSV file"),
    (True, "must be a number"),
    (-1.0, "greater than 0, not -1"),
    (float("inf"), "finite"),
])
def test_bad_values_are_refused(value: Any, words: str) -> None:
    with pytest.raises(InputError, match=words) as e:
        modulus().checked(value, Where("p.toml"))
    assert str(e.value).startswith("p.toml: ")


@pytest.mark.parametrize(("text", "line", "words"), [
    ("depth,E\n0,1\n0.5,nan\n", 3, "finite number, not nan"),
    ("depth,E\n0,1\n0.5,x\n", 3, "'x' is no number"),
    ("depth,E\n0,1\n\n0,2\n", 4, "must rise"),
    ("depth,E\n0,1\n2,2\n", 3, "outside 0"),
    ("depth,E\n0,1\n1\n", 3, "this row has 1 numbers"),
    ("depth,E\n0,1\n1,-2\n", 0, "greater than 0, not -2"),
    ("", 0, "no rows"), ("depth,E\n", 0, "no rows"), ("0,1,2\n1,2,3\n", 0, "3 columns without names"),
])
def test_bad_csv_files_name_file_and_line(tmp_path: Path, text: str, line: int, words: str) -> None:
    path = tmp_path / "E.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=words) as e:
        modulus().checked(str(path), Where("p.toml"))
    assert str(e.value).startswith(f"{path}:{line}: " if line else f"{path}: ")


def test_missing_csv(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot read .*none\.csv: No such file.*relative to"):
        modulus().checked("none.csv", Where(str(tmp_path / "p.toml")))
    (tmp_path / "b.csv").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(InputError, match="no text in UTF-8"):
        modulus().checked("b.csv", Where(str(tmp_path / "p.toml")))

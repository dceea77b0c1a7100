"""Driving data from files: CSV and NetCDF of a tissue or an experiment."""

import numpy as np
import pytest

from febkit.coupling import handoff, read_driving, read_points, series
from febkit.coupling.taylor import orders
from febkit.model import InputError

from .conftest import Polynomial, field


def put(tmp_path, text, name="d.csv"):
    p = tmp_path / name
    p.write_text(text)
    return p


def test_an_experiment_needs_only_time_and_some_of_F(tmp_path):
    ds = read_driving(put(tmp_path, "# stretch test\ntime, Fzz, F12, p\n0, 1, 0, 0\n2, 0.9, 0.05, 0.3\n"))
    assert ds["F"].values[0, 1].tolist() == [[1, 0.05, 0], [0, 1, 0], [0, 0, 0.9]]
    assert ds["p"].values[0].tolist() == [0, 0.3]
    assert orders(ds) == (1, 0, -1)
    X = np.array([[1.0, 2.0, 3.0]])
    h = handoff(ds, X, order=1, fluid_order=0)
    assert h.u[1, 0] == pytest.approx([0.1, 0, -0.3])
    assert h.p[1, 0] == 0.3


def test_second_and_third_derivatives_are_symmetric(tmp_path):
    ds = read_driving(put(tmp_path, "t;F11;Gxyz;G3zxyy;grad_p_x;Hxz\n1;1;2;3;4;5\n"))
    assert ds["G"].values[0, 0, 0, 1, 2] == ds["G"].values[0, 0, 0, 2, 1] == 2
    assert [ds["G3"].values[0, 0, 2][i] for i in ((0, 1, 1), (1, 0, 1), (1, 1, 0))] == [3, 3, 3]
    assert ds["grad_p"].values[0, 0].tolist() == [4, 0, 0]
    assert ds["H"].values[0, 0, 2, 0] == 5


def test_several_points_share_a_file(tmp_path):
    ds = read_driving(put(tmp_path, "point time Fxx\n1 0 1\n1 1 1.1\n2 0 1\n2 1 1.2\n"))
    assert ds["F"].values[:, 1, 0, 0].tolist() == [1.1, 1.2]


@pytest.mark.parametrize(("text", "message"), [
    ("time,Fxx\n", "needs a head and at least one row"),
    ("time,Fxx\n0,1\n0,2\n", "times must be finite and increase"),
    ("time,Fxx\n0,abc\n", r"d\.csv:2: column Fxx: 'abc' is not a number"),
    ("time,Fxx\n0\n", "1 values for 2 columns"),
    ("time,Q\n0,1\n", 'column "Q" is not known'),
    ("time,Fx\n0,1\n", 'column "Fx" is not known'),
    ("time,p\n0,1\n", "no column of F"),
    ("Fxx\n1\n", "must be called time"),
    ("time,Fxx\n0,nan\n", "not numbers"),
    ("point,time,Fxx\n1,0,1\n2,1,1\n", "point 2 has other times"),
])
def test_what_is_wrong_in_a_csv_file_is_named(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        read_driving(put(tmp_path, text))


def test_a_series_saved_as_netcdf_drives_again(tmp_path):
    f = field("hex8", 3, Polynomial(1, 1), lambda x: x[:, 0])
    ds = series(f, [[0, 0, 0], [0.2, 0.1, 0]], order=2, names=["a", "b"])
    ds.to_netcdf(tmp_path / "s.nc")
    back = read_driving(tmp_path / "s.nc")
    for name in ("F", "G", "p", "grad_p", "H", "X"):
        assert np.array_equal(back[name].values, ds[name].values)
    assert back.attrs["recovery"] == "patches" and back["point"].values.tolist() == ["a", "b"]
    assert back.attrs["elements"] == "27 hex8"


def test_driving_data_need_F_over_time(tmp_path):
    import xarray as xr

    xr.Dataset({"q": ("time", [1.0])}).to_netcdf(tmp_path / "q.nc")
    with pytest.raises(InputError, match="need F over time; there is q"):
        read_driving(tmp_path / "q.nc")
    xr.Dataset({"F": (("time", "i"), [[1.0, 2, 3]])}, {"time": [0.0]}).to_netcdf(tmp_path / "r.nc")
    with pytest.raises(InputError, match="F must have dimensions"):
        read_driving(tmp_path / "r.nc")
    with pytest.raises(InputError, match="not a NetCDF"):
        read_driving(put(tmp_path, "nothing", "n.nc"))
    with pytest.raises(InputError, match="no such file"):
        read_driving(tmp_path / "none.csv")


def test_points_are_read_with_or_without_a_head(tmp_path):
    points, names = read_points(put(tmp_path, "name,x,y,z\ncell 1,1,2,3\ncell 2,4,5,6\n"))
    assert points.tolist() == [[1, 2, 3], [4, 5, 6]]
    points, names = read_points(put(tmp_path, "1 2 3\n4 5 6\n"))
    assert names == ["0", "1"] and points[1].tolist() == [4, 5, 6]
    with pytest.raises(InputError, match=r"d\.csv:2: .* is no point"):
        read_points(put(tmp_path, "1,2,3\n4,5\n"))

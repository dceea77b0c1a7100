"""Scenes are drawn without a display, show what they should, and say what is wrong."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

from febkit.cli.plot import command
from febkit.model import InputError
from febkit.plots import animation, canvas, movie, render, save
from febkit.plots import scene as figure

from .test_figures import block


@pytest.fixture
def pv():
    return pytest.importorskip("pyvista", reason="scenes need pyvista")


def scene(ds, path, *args, **options):
    save(figure(ds, *args, **options), path)


def pixels(path):
    from matplotlib.image import imread

    return imread(path)[..., :3]


def colourful(path) -> float:
    """Share of pixels that are neither black, grey nor white: those of the colour map."""
    return float((np.ptp(pixels(path), axis=-1) > 0.15).mean())


def sheared():
    ds = block()
    ds["pressure"] = (("time", "node"), np.stack([0 * ds["X"].values[:, 2], ds["X"].values[:, 2]]))
    return ds


@pytest.mark.parametrize("plane", [None, "x=0.5", "y=0.3", "z=1"])
def test_a_scene_is_no_blank_picture(pv, tmp_path, plane):
    scene(sheared(), tmp_path / "s.png", "pressure", 1.0, plane, size=(400, 300))
    assert pixels(tmp_path / "s.png").shape == (300, 400, 3)
    assert 0.1 < colourful(tmp_path / "s.png") < 0.9


def test_arrows_are_seen(pv, tmp_path):
    for name, arrows in (("without", None), ("with", "fluid flux")):
        scene(sheared(), tmp_path / f"{name}.png", "pressure", 1.0, "y=0.5", None, arrows, size=(400, 300))
    a, b = (pixels(tmp_path / f"{name}.png") for name in ("without", "with"))
    changed = (np.abs(a - b).max(axis=-1) > 0.2).mean()
    assert 0.005 < changed < 0.3


def test_the_cut_lies_in_the_deformed_material_plane(pv):
    body = render.grid(pv, sheared(), 1, np.arange(64))
    _, face = render._opened(body, render.Plane("x", 0.5))
    # X = 0.5 and x = X + 0.2 Z, z = 0.9 Z
    assert np.allclose(face.points[:, 0], 0.5 + 0.2 * face.points[:, 2] / 0.9, atol=1e-5)
    assert face.n_cells == 16
    # where element faces lie in the plane, the elements of the half that is kept are cut
    assert set(face.cell_data["part"]) == {0}
    assert face.area == pytest.approx(0.9 * np.hypot(1, 0.2 / 0.9), rel=1e-5)


def test_parts_are_shown_alone(pv):
    ds = sheared()
    body = render.grid(pv, ds, 1, np.flatnonzero(ds["part"].values == 1))
    assert body.n_cells == 32 and set(body.cell_data["part"]) == {1}
    assert body.bounds[0] == 0.5  # nodes of the rest are left out
    with pytest.raises(InputError, match="misses"):
        render._opened(body, render.Plane("x", 0.2))


def test_a_plane_between_parts_is_refused(pv):
    ds = sheared()
    x = ds["X"].values[ds["connectivity"].values].mean(axis=1)[:, 0]
    apart = render.grid(pv, ds, 1, np.flatnonzero(np.abs(x - 0.5) > 0.3))
    with pytest.raises(InputError, match="cuts none"):
        render._opened(apart, render.Plane("x", 0.5))


def test_what_is_wrong_is_said(pv, tmp_path):
    out = tmp_path / "s.png"
    for words, options in (
        ("misses the body", {"plane": "x=7"}),
        ("is no plane", {"plane": "w=1"}),
        ("no state at", {"time": 0.4}),
        ("the result has no", {"variable": "temperature"}),
        ("is no vector", {"arrows": "pressure"}),
    ):
        with pytest.raises(InputError, match=words):
            scene(sheared(), out, **{"variable": "pressure", **options})
    assert not out.exists()


def test_camera_limits_scale_and_colours_change_the_picture(pv, tmp_path):
    plain = dict(variable="pressure", time=1.0, size=(400, 300))
    base = figure(sheared(), **plain)
    base.canvas.draw()
    ours = np.array(base.canvas.buffer_rgba())
    for other in ({"camera": "-z"}, {"camera": "30,20"}, {"zoom": 0.6}, {"limits": (0.0, 5.0)}, {"colours": "cividis"},
                  {"scale": 0.0}):  # fmt: skip
        f = figure(sheared(), **plain, **other)
        f.canvas.draw()
        assert (np.array(f.canvas.buffer_rgba()) != ours).any(axis=-1).mean() > 0.01, other
    with pytest.raises(InputError, match="no camera"):
        figure(sheared(), camera="above", **plain)
    with pytest.raises(InputError, match="no colour map is called 'virdis'; viridis"):
        figure(sheared(), colours="virdis", **plain)


def test_a_bar_and_a_ruler_say_quantity_and_units(pv, tmp_path):
    ds = sheared()
    ds["X"].attrs["units"], ds["pressure"].attrs["units"] = "um", "kPa"
    f = figure(ds, "pressure", 1.0, camera="y")
    assert f.axes[-1].get_ylabel() == "pressure (kPa)"
    ruler = f.axes[0].lines[0].get_xdata()
    words = [t.get_text() for t in f.axes[0].texts]
    assert words[-1] == "0.2 µm" and {"x", "z"} <= set(words) and "y" not in words
    # the cube is 1.2 um wide at the sheared end
    width = f.axes[0].images[0].get_array().shape[1]
    coloured = np.ptp(np.asarray(f.axes[0].images[0].get_array(), dtype=int), axis=-1) > 40
    across = np.flatnonzero(coloured.any(axis=0))
    assert (across[-1] - across[0]) / np.ptp(ruler) * 0.2 == pytest.approx(1.2, abs=0.02) and width > 1000


def test_movies_hold_a_picture_for_each_state(pv, tmp_path):
    from PIL import Image

    movie(sheared(), tmp_path / "m.gif", "pressure", size=(300, 240), limits=(0.0, 1.0))
    with Image.open(tmp_path / "m.gif") as gif:
        assert gif.n_frames == 2 and gif.size == (300, 240)
        gif.seek(0)
        first = np.asarray(gif.convert("RGB"), dtype=int)
        gif.seek(1)
        last = np.asarray(gif.convert("RGB"), dtype=int)
    assert (np.abs(first - last).max(axis=-1) > 60).mean() > 0.05
    with pytest.raises(InputError, match="ends in"):
        movie(sheared(), tmp_path / "m.avi", "pressure")


class Shell(dict):
    points = np.eye(3)


def test_a_movie_builds_each_state_once(tmp_path, monkeypatch):
    built = []
    shot = SimpleNamespace(plane=None, at=lambda t: built.append(t) or (Shell(colour=[0.0, 1.0]), None))
    monkeypatch.setattr(animation, "shot", lambda *_, **__: shot)
    monkeypatch.setattr(animation, "_page", lambda *_: canvas.blank(1, 1))
    movie(sheared(), tmp_path / "m.gif", "pressure")
    assert built == [0, 1] and (tmp_path / "m.gif").stat().st_size > 0


def test_an_mp4_can_be_read_again(pv, tmp_path):
    ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="MP4 needs imageio-ffmpeg")
    movie(sheared(), tmp_path / "m.mp4", "pressure", size=(301, 241))
    reader = ffmpeg.read_frames(str(tmp_path / "m.mp4"))
    assert next(reader)["size"] == (300, 240)
    assert len(list(reader)) == 2


def test_a_missing_pyvista_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(InputError, match=r"febkit\[scenes\]"):
        scene(sheared(), tmp_path / "s.png", "pressure")


def test_the_verb_draws_a_plotfile(pv, tmp_path):
    from febkit.results import write

    write(sheared(), tmp_path / "run.xplt")
    arguments = ["scene", str(tmp_path / "run.xplt"), "-v", "displacement:x", "--plane", "y=0.5", "--arrows"]
    done = CliRunner().invoke(command, [*arguments, "fluid flux", "-p", "cell*", "-o", str(tmp_path / "s.png")])
    assert done.exit_code == 0, done.output
    assert colourful(tmp_path / "s.png") > 0.05

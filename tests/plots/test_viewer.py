"""The viewer in a real browser: what is clicked there changes the picture, and the picture says what is clicked."""

from __future__ import annotations

import io
import time

import numpy as np
import pytest

pytest.importorskip("pyvista", reason="the viewer needs pyvista")
pytest.importorskip("trame", reason="the viewer needs trame")
pytest.importorskip("trame_vtk", reason="the viewer needs trame-vtk")
pytest.importorskip("trame_vuetify", reason="the viewer needs trame-vuetify")

import febkit
from febkit.model import InputError
from febkit.results import write
from febkit.viewer import Show, Stage
from helpers.browser import chromium

from .test_figures import block

PATIENCE = 60.0


def result():
    """A sheared cube of two parts; the pressure is 10 z at the end."""
    ds = block(4).assign_attrs(unit_system="mm-N-s")
    z = ds["X"].values[:, 2]
    ds["pressure"] = (("time", "node"), np.stack([0 * z, 10 * z]), {"units": "MPa"})
    ds["strength"] = (("time", "element"), np.stack([0.0 * np.arange(64), 1.0 + np.arange(64)]))
    return ds


@pytest.fixture(scope="module")
def browser():
    d = chromium()
    yield d
    d.quit()


def until(ask, what):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = ask()
        if found:
            return found
        time.sleep(0.1)
    raise AssertionError(f"not within {PATIENCE:g} s: {what}")


def text(browser, name):
    return browser.find_element("id", name).get_attribute("textContent").strip()


def body(browser):
    """Where the mesh is: coloured pixels right of the controls, left of the colour bar; and the whole picture."""
    from PIL import Image

    a = np.asarray(Image.open(io.BytesIO(browser.get_screenshot_as_png())).convert("RGB"), dtype=int)
    mine = np.ptp(a, axis=-1) > 35
    mine[:, :270] = mine[:, 980:] = False
    mine[:60] = mine[-170:, :480] = False  # controls, axes
    return mine, a


def still(browser):
    """The picture, once it does not change any more."""
    before = body(browser)
    for _ in range(100):
        time.sleep(0.4)
        now = body(browser)
        if (now[1] == before[1]).all():
            return now
        before = now
    raise AssertionError("the picture does not come to rest")


def opened(browser, view):
    browser.get(view.url)
    until(lambda: browser.find_elements("id", "drawn"), "the page")
    until(lambda: body(browser)[0].sum() > 5000, "the mesh in the picture")
    return still(browser)


def drawn_after(browser, act):
    """The picture after something that draws anew."""
    n = int(text(browser, "drawn"))
    act()
    until(lambda: int(text(browser, "drawn")) > n, "a new picture")
    return still(browser)


def changed(a, b):
    return int((np.abs(a[1] - b[1]).max(axis=-1)[60:, 270:980] > 25).sum())


def click(browser, selector):
    browser.execute_script("arguments[0].click()", browser.find_element("css selector", selector))


def test_time_cuts_parts_and_picking_in_a_browser(browser, tmp_path):
    from selenium.webdriver import ActionChains, Keys

    write(result().rename(pressure="effective_fluid_pressure"), tmp_path / "run.xplt")
    view = febkit.open_results(tmp_path / "run.xplt").febkit.view("effective fluid pressure")
    try:
        assert "127.0.0.1" in view.url and "<iframe" in view._repr_html_()
        end = opened(browser, view)
        assert text(browser, "clock") == "t = 1 s" and 20_000 < end[0].sum() < 300_000

        # a click on the middle of what is seen says node, element and the pressure 10 Z there
        rows, columns = np.nonzero(end[0])
        picture = browser.find_element("id", "picture")
        box = picture.rect
        x, y = columns.mean() - box["x"] - box["width"] / 2, rows.mean() - box["y"] - box["height"] / 2
        ActionChains(browser).move_to_element_with_offset(picture, int(x), int(y)).click().perform()
        said = until(lambda: text(browser, "picked"), "what was picked")
        node = int(said.split()[1])
        z = float(result()["X"].values[node - 1, 2])
        assert said.startswith(f"node {node} (element ") and said.endswith(f"fluid pressure = {10 * z:g} MPa"), said

        cut = drawn_after(browser, lambda: click(browser, "#cut-x"))
        assert changed(cut, end) > 2000
        whole = drawn_after(browser, lambda: click(browser, "#cut-none"))
        assert changed(whole, end) < 200

        thumb = browser.find_elements("css selector", "[role=slider]")[0]
        first = drawn_after(browser, lambda: thumb.send_keys(Keys.ARROW_LEFT))
        assert text(browser, "clock") == "t = 0 s" and changed(first, end) > 10_000

        half = drawn_after(browser, lambda: click(browser, "[aria-label=cell1]"))
        assert half[0].sum() < 0.8 * first[0].sum()
    finally:
        view.stop()
    assert not view.running


def test_a_file_that_grows_is_followed(browser, tmp_path):
    """As a run writes it: states are added to the file that is open."""
    write(result(), tmp_path / "whole.xplt")
    whole = (tmp_path / "whole.xplt").read_bytes()
    write(result().isel(time=[0]), tmp_path / "first.xplt")
    n = (tmp_path / "first.xplt").stat().st_size
    (tmp_path / "run.xplt").write_bytes(whole[: n + 10])
    view = febkit.view(tmp_path / "run.xplt", "strength")
    try:
        browser.get(view.url)
        until(lambda: browser.find_elements("id", "last"), "the page")
        assert (text(browser, "last"), text(browser, "clock")) == ("0", "t = 0 s")
        with (tmp_path / "run.xplt").open("ab") as f:
            f.write(whole[n + 10 :])
        until(lambda: text(browser, "last") == "1" and text(browser, "clock") == "t = 1 s", "the state that was added")
    finally:
        view.stop()


def test_the_stage_picks_elements_behind_a_cut():
    """On the face of a cut x = 0.5 the element of the half that is kept, with its own value."""
    stage = Stage(result(), Show("strength", cut="x", at=0.5, scale=0.0))
    assert stage.draw() == ""
    stage.look("x")
    width, height = stage.plotter.window_size
    stage.plotter.render_window.Render()
    found = stage.pick(0.44 * width, 0.5 * height)
    assert (found["element"] - 1) // 16 == 1 and found["value"] == found["element"] and found["part"] == "ecm"
    assert stage.pick(1, 1) is None
    stage.close()


def test_what_cannot_be_shown_is_said():
    stage = Stage(result(), Show("pressure"))
    stage.set(parts=())
    assert stage.draw() == "no part is shown: tick one"
    with pytest.raises(InputError, match="the result has no 'temperature'"):
        stage.set(variable="temperature")
    assert stage.show.variable == "pressure"
    stage.close()


def test_colours_span_the_run_or_a_state():
    stage = Stage(result(), Show("pressure", t=0))
    stage.draw()
    assert stage._limits(None, None) == pytest.approx((0, 10), abs=0.2)
    stage.set(fit=True)
    assert stage.draw() == "" and stage.plotter.scalar_bar.GetLookupTable().GetRange()[1] < 2
    stage.close()


def test_the_verb_serves_a_page_until_ctrl_c(tmp_path):
    import signal
    import subprocess
    import sys
    from urllib.request import urlopen

    from helpers.command import FEBKIT

    if sys.platform == "win32":
        pytest.skip("Ctrl-C is sent by a signal")
    write(result(), tmp_path / "run.xplt")
    command = [str(FEBKIT), "view", "run.xplt", "--no-browser", "-v", "strength"]
    p = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        line = p.stdout.readline()
        assert line.startswith("run.xplt is shown at http://127.0.0.1:"), (line, p.stderr.read())
        with urlopen(line.split()[4]) as page:
            assert page.status == 200
        p.send_signal(signal.SIGINT)
        _, err = p.communicate(timeout=60)
        assert (p.returncode, err) == (0, ""), err
    finally:
        p.kill()


def test_the_verb_says_what_is_wrong(tmp_path):
    from helpers.forked import febkit as run

    write(result(), tmp_path / "run.xplt")
    done = run("view", "run.xplt", "--no-browser", "-v", "temperature", folder=tmp_path)
    assert done.returncode == 2 and "the result has no 'temperature'" in done.stderr and "Traceback" not in done.stderr

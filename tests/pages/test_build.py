"""The site is built without a warning, and has what it should have."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from helpers.browser import chromium

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    for needed in ("sphinx", "furo", "myst_parser", "sphinx_copybutton"):
        pytest.importorskip(needed, reason='needs pip install "febkit[docs]"')
    out = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-d", str(out / "doctrees"), "docs"]
    done = subprocess.run([*command, str(out / "html")], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr.lower(), done.stderr
    return out / "html"


def test_the_reference_holds_what_is_public(built: Path) -> None:
    import febkit
    from febkit import plots

    said = "".join(p.read_text() for p in (built / "api").glob("*.html"))
    public = [f"febkit.{n}" for n in febkit.__all__ if n not in ("__version__", "materials")]
    public += [f"febkit.plots.{n}" for n in plots.__all__]
    public += ["febkit.Model.prescribe", "febkit.Model.solve", "febkit.results.accessor.Results.reaction"]
    assert [n for n in public if f'id="{n}"' not in said] == []


def test_a_material_s_table_has_its_parameters(built: Path) -> None:
    page = (built / "_made" / "materials.html").read_text()
    section = page.split('<section id="neohookean">')[1].split("</section>")[0]
    assert re.search(r"<code[^>]*><span class=\"pre\">E</span></code>", section) and "more than 0" in section


def test_links_between_pages_lead_somewhere(built: Path) -> None:
    for page in built.rglob("*.html"):
        for link in re.findall(r'href="([^"#:]+\.html)', page.read_text()):
            assert (page.parent / link).resolve().is_file(), f"{page.relative_to(built)}: {link}"


def test_pages_fit_a_browser_s_window_and_show_their_pictures(built: Path) -> None:
    browser = chromium(1280, 900)
    try:
        for page in sorted(built.rglob("*.html")):
            name = str(page.relative_to(built))
            browser.get(page.as_uri())
            root = "return document.documentElement."
            wide, window = (browser.execute_script(f"{root}{w}Width") for w in ("scroll", "client"))
            assert wide <= window, f"{name} is {wide} pixels wide"
            lost = "return [...document.images].filter(i => !i.complete || !i.naturalWidth).map(i => i.src)"
            assert browser.execute_script(lost) == [], name
        browser.get((built / "index.html").as_uri())
        assert browser.title.startswith("febkit") and len(browser.find_elements("css selector", "article img")) == 1
    finally:
        browser.quit()

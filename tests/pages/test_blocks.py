"""The code of the pages runs, page by page, in the order in which a reader meets it, and prints what is shown below it.

With ``FEBKIT_PICTURES=1`` the pictures that a page's code makes are put into ``docs/pictures``.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from helpers import pages
from helpers.pages import DOCS, ROOT, Block, blocks

SHOWN = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
LANGUAGES = {"python", "sh", "text", "xml", "toml", "{toctree}", "{eval-rst}", "{include}", "{literalinclude}"}
NAMED = {str(p.relative_to(ROOT)): p for p in pages.pages()}
WITH_CODE = [n for n, p in NAMED.items() if any(b.language in pages.RUN and not b.aside for b in blocks(p.read_text()))]


@pytest.fixture(scope="module")
def furnished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pages")
    pages.furnish(folder)
    shutil.copytree(ROOT / "examples", folder / "examples", ignore=shutil.ignore_patterns("out", "__pycache__"))
    return folder


@pytest.mark.parametrize("page", NAMED)
def test_every_block_says_what_it_is(page: str) -> None:
    """Blocks have a language; what is not run says why."""
    text = NAMED[page].read_text()
    for b in blocks(text):
        assert b.language.partition(" ")[0] in LANGUAGES, f"{page}:{b.line}: {b.language!r}"
    if page != "README.md":  # whose two commands are plain
        assert pages.indented(text) == [], page
    asides = len(re.findall("<!-- not run", text))
    assert asides == sum(bool(b.aside) and b.language in pages.RUN for b in blocks(text)), f"{page}: a stray aside"


@pytest.mark.parametrize("page", WITH_CODE)
def test_the_code_of_a_page_runs(
    page: str, furnished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib").use("agg")
    for needed in re.findall(r"<!-- needs: (\w+) -->", NAMED[page].read_text()):
        pytest.importorskip(needed)
    here = tmp_path / "here"
    shutil.copytree(furnished, here)
    monkeypatch.chdir(here)
    there: dict[str, Any] = {"__name__": "__main__"}
    for b in blocks(NAMED[page].read_text()):
        if b.language not in pages.RUN or b.aside:
            continue
        where = f"{page}:{b.line}"
        said = shell(b, where) if b.language == "sh" else python(b, where, there)
        if b.output is not None:
            assert doctest.OutputChecker().check_output(b.output, said, SHOWN), f"{where} prints\n{said}"
    pictures(page, here)


def python(b: Block, where: str, there: dict[str, Any]) -> str:
    said = io.StringIO()
    code = compile("\n" * b.line + b.text, str(ROOT / where.partition(":")[0]), "exec")
    with contextlib.redirect_stdout(said):
        exec(code, there)
    return said.getvalue()


def shell(b: Block, where: str) -> str:
    if shutil.which("bash") is None:
        pytest.skip("needs bash")
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    env = {**os.environ, "PATH": path, "MPLBACKEND": "agg", "COLUMNS": "100"}
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", b.text], env=env,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, timeout=600)  # fmt: skip
    assert done.returncode == 0, f"{where}\n{done.stdout}"
    return done.stdout


def pictures(page: str, here: Path) -> None:
    """Pictures in docs/pictures are those that the page's own code makes."""
    shown = re.findall(r"\]\((?:docs/|\.\./)?pictures/([\w.-]+)\)", NAMED[page].read_text())
    for name in shown:
        if not (here / name).is_file():
            continue
        if os.environ.get("FEBKIT_PICTURES"):
            shutil.copy(here / name, DOCS / "pictures" / name)
    for made in here.glob("*.png"):
        if f"pictures/{made.name}" in NAMED[page].read_text():
            assert (DOCS / "pictures" / made.name).is_file(), f"FEBKIT_PICTURES=1 pytest {__file__}"


def test_every_picture_is_made_by_a_page() -> None:
    """Each file of docs/pictures is shown by a page whose code names it."""
    for p in (DOCS / "pictures").iterdir():
        makers = [n for n, page in NAMED.items() if sum(p.name in b.text for b in blocks(page.read_text()))
                  and f"pictures/{p.name}" in page.read_text()]  # fmt: skip
        assert makers, p.name

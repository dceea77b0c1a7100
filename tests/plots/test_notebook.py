"""Figures appear in notebooks: through a real Jupyter kernel, with and without %matplotlib."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest

nbclient = pytest.importorskip("nbclient", reason="notebooks are run by nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel", reason="notebooks need a kernel")
pytest.importorskip("matplotlib")

DATA = """
import numpy as np, xarray as xr
from febkit import plots
t = np.linspace(0, 1, 5)
ds = xr.Dataset({"energy": ("time", t**2, {"units": "mJ"})}, coords={"time": t})
"""


@pytest.mark.parametrize("before", ["", "%matplotlib inline"])
def test_a_figure_is_shown_once(before, tmp_path):
    from PIL import Image

    book = nbformat.v4.new_notebook()
    book.cells = [nbformat.v4.new_code_cell(c) for c in (before + chr(10) + DATA, 'plots.xy(ds, "energy")')]
    place = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(book, timeout=300, kernel_name="python3", resources=place).execute()
    shown = [o for o in book.cells[1].outputs if "data" in o]
    assert len(shown) == 1
    picture = Image.open(io.BytesIO(base64.b64decode(shown[0]["data"]["image/png"])))
    a = np.asarray(picture.convert("RGB"), dtype=int)
    assert min(a.shape[:2]) > 200
    assert (np.abs(a - [0x00, 0x72, 0xB2]).max(axis=-1) < 30).sum() > 100  # the line

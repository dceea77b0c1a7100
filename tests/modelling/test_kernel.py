"""What a notebook shows and completes, asked of a real Jupyter kernel."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest

jupyter = pytest.importorskip("jupyter_client", reason="kernels are talked to by jupyter_client")
pytest.importorskip("ipykernel", reason="notebooks need a kernel")

SETUP = """
import febkit
from febkit import materials as mt
m = febkit.Model("biphasic", units="mm-N-s")
m.add_block("block", (1, 1, 1), (1, 1, 1))
m.materials["cartilage"] = mt.Biphasic(
    solid=mt.NeoHookean(E=0.6, v=0.1), permeability=mt.PermConstIso(perm=1), phi0=0.2)
m.node_sets["top"] = m.nodes(z="max")
m.step(time=1, dt=0.5)
"""


@pytest.fixture(scope="module")
def kernel() -> Iterator[Any]:
    manager = jupyter.KernelManager(kernel_name="python3")
    manager.start_kernel()
    client = manager.client()
    client.start_channels()
    try:
        client.wait_for_ready(timeout=60)
        assert client.execute(SETUP, reply=True, timeout=60)["content"]["status"] == "ok"
        yield client
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


@pytest.mark.parametrize(
    "code, offered",
    [
        ("febkit.", ["Model", "read", "solve", "open_results", "materials", "view"]),
        ("m.", ["nodes", "prescribe", "materials", "steps", "touch", "solve"]),
        ("mt.NeoH", ["NeoHookean"]),
        ("m.materials['", ["cartilage"]),
        ("m.materials['cartilage'].", ["solid", "permeability", "phi0"]),
        ("m.materials['cartilage'].solid.", ["E", "v", "density"]),
        ("m.node_sets['", ["top"]),
        ("m.parts['", ["block"]),
        ("m.steps[0].control.time_stepper.", ["dtmax", "max_retries"]),
    ],
)
def test_tab_completes(kernel: Any, code: str, offered: list[str]) -> None:
    matches = kernel.complete(code, reply=True, timeout=60)["content"]["matches"]
    ends = {m.rpartition(".")[2].rpartition("['")[2].rstrip("']") for m in matches}
    assert set(offered) <= ends, sorted(ends)


def test_a_constructor_s_help_has_parameters_and_the_law(kernel: Any) -> None:
    data = kernel.inspect("mt.NeoHookean", reply=True, timeout=60)["content"]["data"]
    said = re.sub(r"\x1b\[[0-9;]*m", "", data["text/plain"])
    assert "NeoHookean(*, E=" in said and "FEBio's \"neo-Hookean\"." in said


def test_a_model_says_what_is_in_it(kernel: Any) -> None:
    shown: list[dict[str, Any]] = []
    kernel.execute_interactive(
        "m", timeout=60, output_hook=lambda msg: shown.append(msg["content"].get("data", {})))  # fmt: skip
    data = next(d for d in shown if "text/html" in d)
    assert "part block: 1 hex8, material cartilage" in data["text/plain"] and "<pre>" in data["text/html"]

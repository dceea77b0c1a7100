"""Meshes that adaptors refine, beside FEBio 4.11: nodes and elements, who is where, displacements, stress."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit import results
from helpers.refined import (
    ABOVE,
    AUTO,
    CUT,
    ERROR,
    EVERY,
    FLUID,
    MOONEY,
    PRESSURE,
    PULL,
    VISCOUS,
    WEIGHT,
    adaptor,
    chosen,
    deck,
)


def marks(path: Path) -> list[tuple[int, int, int, float, float]]:
    """Of each state: numbers of nodes and elements, a sum of the connectivity, weighed displacement and stress."""
    out = []
    for ds in results.open_all(path):
        conn = ds.connectivity.values.astype("<i4")
        for k in range(ds.sizes["time"]):
            u, s = (ds[v].values[k].astype(float) for v in ("displacement", "stress"))
            weighed = [float(np.linspace(1, 2, len(v)) @ v @ np.arange(1.0, v.shape[1] + 1)) for v in (u, s)]
            out.append((len(u), len(s), zlib.crc32(conn.tobytes()), *weighed))
    return out


DATA = ('<criterion type="min-max filter"><min>-1</min><clamp>0</clamp><data type="element data"><element_data>{}'
        "</element_data></data></criterion>")  # fmt: skip
CASES: dict[str, dict[str, Any]] = {
    "nodes cease to hang": {"adaptor": adaptor("hex_refine", chosen("1,9"), max_iters=1), "steps": 3},
    "by the error of stress": {"adaptor": adaptor("hex_refine", ERROR, max_iters=2, max_value=0.18), "loads": PULL},
    "two parts, labels that descend": {
        "adaptor": adaptor("hex_refine", chosen("1,6,9,12"), max_iters=1), "parts": 2, "first": 8, "loads": WEIGHT,
    },
    "some at a time, by stress": {
        "adaptor": adaptor("hex_refine", ABOVE, max_iters=2, max_elem_refine=3, max_elements=60), "material": MOONEY,
    },
    "a law forgets": {"adaptor": adaptor("hex_refine", chosen("1,6"), max_iters=1), "material": VISCOUS},
    "dynamics": {"adaptor": adaptor("hex_refine", chosen("1,6"), max_iters=1), "analysis": "DYNAMIC"},
    "by what is cut to a range": {"adaptor": adaptor("hex_refine", CUT, max_iters=1, max_value=0.12)},
    **{
        f"by {name}": {"adaptor": adaptor("hex_refine", DATA.format(name), max_iters=1, max_value=value)}
        for name, value in (("s1", 0.02), ("sxz", 0.004), ("J", 1.002))
    },
    "steps of their own size": {
        "adaptor": adaptor("hex_refine", chosen("1,2"), max_iters=1), "stepper": AUTO, "steps": 3, "relative": 1,
    },
    "in the plane": {
        "adaptor": adaptor("hex_refine2d", ERROR, max_iters=2, max_value=0.2), "n": (4, 2, 1), "loads": PRESSURE,
    },
    "in the plane, nodes cease to hang": {
        "adaptor": adaptor("hex_refine2d", chosen("1,5,4"), max_iters=1), "n": (4, 2, 1), "steps": 3,
    },
    "tetrahedra": {
        "adaptor": adaptor("tet_refine", max_iters=1, max_elements=90), "n": (2, 1, 1), "kind": "tet4",
        "loads": PRESSURE + PULL + WEIGHT,
    },
    "nothing but a new start": {
        "adaptor": adaptor("test_refine", max_iters=1), "n": (2, 1, 1), "kind": "tet4", "material": VISCOUS,
    },
    "a mixture": {"adaptor": adaptor("hex_refine", EVERY, max_elements=17), "n": (2, 2, 2), **FLUID},
    "a mixture of tetrahedra": {
        "adaptor": adaptor("tet_refine", max_elements=13), "n": (2, 1, 1), "kind": "tet4", **FLUID,
    },
}  # fmt: skip
# nodes, elements, CRC-32 of the connectivity, weighed displacement and stress of each state, in FEBio
FEBIO: dict[str, list[tuple[int, int, int, float, float]]] = {
    "by s1": [
        (45, 16, 3846414515, 0, 0),
        (45, 16, 3846414515, 12.28273, 0.2871601),
        (78, 30, 3245734477, 22.93491, 1.690019),
    ],
    "by sxz": [
        (45, 16, 3846414515, 0, 0),
        (45, 16, 3846414515, 12.28273, 0.2871601),
        (154, 72, 2598032647, 77.3475, 3.748261),
    ],
    "by J": [
        (45, 16, 3846414515, 0, 0),
        (102, 44, 3011201180, 15.46588, 1.169902),
        (275, 142, 2199283268, 65.43694, 9.550122),
    ],
    "nodes cease to hang": [
        (45, 16, 3846414515, 0, 0),
        (83, 30, 160972580, 17.65726, 0.7298104),
        (116, 44, 2296936442, 33.29123, 2.121556),
        (135, 51, 2004662831, 48.92198, 4.844589),
    ],
    "by the error of stress": [
        (45, 16, 3846414515, 0, 0),
        (119, 51, 539121540, 16.88025, 0.7756734),
        (119, 51, 539121540, 33.83233, 1.621674),
    ],
    "two parts, labels that descend": [
        (45, 16, 3846414515, 0, 0),
        (119, 44, 2649542458, 32.23297, 1.141938),
        (138, 51, 3785446898, 63.36299, 3.874748),
    ],
    "some at a time, by stress": [
        (45, 16, 3846414515, 0, 0),
        (45, 16, 3846414515, 12.22777, 1.921055),
        (144, 58, 11352106, 21.76347, 23.12163),
    ],
    "a law forgets": [
        (45, 16, 3846414515, 0, 0),
        (82, 30, 674678733, 13.02262, 0.9191935),
        (101, 37, 553655264, 25.45009, 3.054695),
    ],
    "dynamics": [
        (45, 16, 3846414515, 0, 0),
        (82, 30, 674678733, 4.337986, 2.475509),
        (101, 37, 553655264, 8.143643, 4.052106),
    ],
    "by what is cut to a range": [
        (45, 16, 3846414515, 0, 0),
        (184, 100, 2918965087, 31.35913, 1.565554),
        (340, 191, 2278613352, 60.54969, 6.234602),
    ],
    "steps of their own size": [
        (45, 16, 3846414515, 0, 0),
        (78, 30, 1206245863, 22.3275, 0.9767225),
        (97, 37, 3594831843, 59.43716, 5.072397),
        (116, 44, 3095581067, 101.3298, 15.74869),
    ],
    "in the plane": [
        (30, 8, 374447609, 0, 0),
        (203, 56, 284587770, 39.01974, 1.048283),
        (203, 56, 284587770, 78.01331, 2.461898),
    ],
    "in the plane, nodes cease to hang": [
        (30, 8, 374447609, 0, 0),
        (72, 17, 3593615261, 10.89926, 0.3163055),
        (96, 23, 72903742, 20.52356, 0.8197737),
        (110, 26, 3090383630, 29.87419, 1.362394),
    ],
    "tetrahedra": [
        (12, 12, 422955644, 0, 0),
        (45, 96, 124061431, 10.95148, 1.819595),
        (45, 96, 124061431, 21.93788, 4.111637),
    ],
    "nothing but a new start": [
        (12, 12, 422955644, 0, 0),
        (12, 12, 422955644, 3.338542, 0.7622056),
        (12, 12, 422955644, 6.65814, 1.589922),
    ],
    "a mixture": [
        (27, 8, 2299922456, 0, 0),
        (125, 64, 1527208368, 30.46326, 1.306553),
        (125, 64, 1527208368, 60.52644, 2.802056),
    ],
    "a mixture of tetrahedra": [
        (12, 12, 422955644, 0, 0),
        (45, 96, 124061431, 10.86424, 2.55744),
        (45, 96, 124061431, 21.48861, 5.184998),
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_refined_mesh(name: str, tmp_path: Path) -> None:
    (tmp_path / "m.feb").write_text(deck(**CASES[name]))
    result = febkit.solve(tmp_path / "m.feb", tmp_path / "m.xplt")
    assert result.converged, result.reason
    for found, given in zip(marks(tmp_path / "m.xplt"), FEBIO[name], strict=True):
        assert found[:3] == given[:3]
        np.testing.assert_allclose(found[3:], given[3:], rtol=1e-5, atol=1e-7)

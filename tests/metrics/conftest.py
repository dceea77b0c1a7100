"""Small results made by hand, in the shape that febkit.results.open gives; they name no units."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from febkit.solver import elements

VOIGT = ["xx", "yy", "zz", "xy", "yz", "xz"]


Mesh = tuple[np.ndarray, np.ndarray]


def ball(n: int, radius: float = 1.0, center: tuple[float, float, float] = (0, 0, 0)) -> Mesh:
    """Hexahedra (e, 8) and nodes of a ball: the cube [-1, 1]^3 of n^3 elements pulled onto it."""
    a = np.linspace(-1, 1, n + 1)
    x = np.stack(np.meshgrid(a, a, a, indexing="ij"), -1).reshape(-1, 3)
    r2, r1 = np.linalg.norm(x, axis=1), np.abs(x).max(axis=1)
    s = np.where(r1 > 0, r1 / np.where(r2 > 0, r2, 1), 1)
    # a cube inside, a sphere outside: keeps the corners' jacobians positive
    w = r1**2
    X = x * ((1 - w) * 0.75 + w * s)[:, None] * radius + np.array(center)
    i, j, k = (g.ravel() for g in np.meshgrid(*[np.arange(n)] * 3, indexing="ij"))
    at = lambda i, j, k: (i * (n + 1) + j) * (n + 1) + k  # noqa: E731
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    conn = np.stack([at(i + a, j + b, k + c) for a, b, c in corners], axis=1)
    return X, conn


def coated(n: int, radius: float, layers: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A ball with ``layers`` of hexahedra around it, each as thick as the ball's outer one."""
    X, inner = ball(n, radius)
    faces = np.concatenate([inner[:, list(f)] for _, f in elements.get("hex8").facets])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    skin = faces[first[count == 1]]
    nodes, at = np.unique(skin, return_inverse=True)
    at = at.reshape(skin.shape)
    rings = [X[nodes] * (1 + 2 * (k + 1) / n) for k in range(layers)]
    index = np.vstack([nodes, len(X) + np.arange(layers * len(nodes)).reshape(layers, -1)])
    shell = np.concatenate([np.hstack([index[k][at], index[k + 1][at]]) for k in range(layers)])
    return np.vstack([X, *rings]), inner, shell


def result(
    X: np.ndarray,
    blocks: list[tuple[str, str, np.ndarray]],
    motion: Callable[[np.ndarray, float], np.ndarray],
    times: tuple[float, ...] = (0.0, 1.0),
    pressure: Callable[[np.ndarray, float], np.ndarray] | None = None,
) -> xr.Dataset:
    """Dataset of blocks (element type, part, connectivity) that move by ``motion(X, t)`` -> x."""
    width = max(c.shape[1] for _, _, c in blocks)
    types = sorted({t for t, _, _ in blocks})
    parts = [p for _, p, _ in blocks]
    conn = np.vstack([np.pad(c, ((0, 0), (0, width - c.shape[1])), constant_values=-1) for _, _, c in blocks])
    count = [len(c) for _, _, c in blocks]
    u = np.stack([motion(X, t) - X for t in times])
    data = {"displacement": (("time", "node", "xyz"), u)}
    if pressure is not None:
        data["effective_fluid_pressure"] = (("time", "node"), np.stack([pressure(X, t) for t in times]))
    coords = {
        "time": list(times),
        "xyz": ["x", "y", "z"],
        "X": (("node", "xyz"), X),
        "node_id": ("node", np.arange(len(X)) + 1),
        "element_id": ("element", np.arange(len(conn)) + 1),
        "part": ("element", np.repeat(np.arange(len(parts)), count)),
        "element_type": ("element", np.repeat([types.index(t) for t, _, _ in blocks], count)),
        "connectivity": (("element", "local"), conn),
    }
    return xr.Dataset(data, coords=coords, attrs={"parts": parts, "element_types": types})


def single(kind: str) -> Mesh:
    """One element of a kind, gently distorted."""
    X = elements.get(kind).natural.copy()
    X = X @ np.array([[1, 0.1, 0], [0, 1.2, 0.2], [0.05, 0, 0.9]]).T
    return X, np.arange(len(X))[None]


@pytest.fixture
def mesh() -> Callable[..., Mesh]:
    return ball


@pytest.fixture
def make() -> Callable[..., xr.Dataset]:
    return result


@pytest.fixture
def one() -> Callable[[str], Mesh]:
    return single


@pytest.fixture
def coated_mesh() -> Callable[..., tuple[np.ndarray, np.ndarray, np.ndarray]]:
    return coated

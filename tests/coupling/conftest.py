"""Small meshes of every element, as fields made of given functions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from febkit.coupling.field import Field, blocks_of
from febkit.solver import elements

LINEAR = {"hex8": "hex8", "hex20": "hex8", "hex27": "hex8", "tet4": "tet4", "tet10": "tet4", "penta6": "penta6"}
# a brick cut into wedges and into tetrahedra, by its corners
CUTS = {
    "hex8": [(0, 1, 2, 3, 4, 5, 6, 7)],
    "penta6": [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)],
    "tet4": [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)],
}


def grid(n: int, low: float = -0.5, high: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and bricks of a cube of n elements along an edge."""
    g = np.linspace(low, high, n + 1)
    z, y, x = np.meshgrid(g, g, g, indexing="ij")
    X = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    k, j, i = (a.ravel() for a in np.meshgrid(*(np.arange(n),) * 3, indexing="ij"))
    m = n + 1

    def node(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        return (c * m + b) * m + a

    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    conn = np.stack([node(i + a, j + b, k + c) for c in (0, 1) for a, b in ring], axis=1)
    return X, conn


def mesh(kind: str, n: int, warp: Callable[[np.ndarray], np.ndarray] | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (m, 3) and connectivity of a cube of ``kind``; ``warp`` moves the nodes."""
    X, bricks = grid(n)
    linear = LINEAR[kind]
    cells = np.concatenate([bricks[:, list(c)] for c in CUTS[linear]])
    if kind != linear:
        shape = elements.get(linear).shape(elements.get(kind).natural)
        places = np.einsum("an,eni->eai", shape, X[cells])
        _, first, back = np.unique(np.round(places.reshape(-1, 3), 9), axis=0, return_index=True, return_inverse=True)
        X, cells = places.reshape(-1, 3)[first], back.reshape(len(cells), -1)
    return (X if warp is None else warp(X)), cells


def bent(X: np.ndarray) -> np.ndarray:
    """A smooth map that curves edges and faces a little."""
    x, y, z = X.T
    return X + 0.04 * np.stack([np.sin(2 * y) * z, x * x - z, np.cos(2 * x) * y], axis=1)


def skewed(X: np.ndarray) -> np.ndarray:
    """An affine map: elements become parallelepipeds."""
    return X @ np.array([[1.0, 0.2, 0.1], [0.0, 0.9, 0.3], [0.1, 0.0, 1.1]]).T


def field(kind: str, n: int, u: Callable[[np.ndarray], np.ndarray], p: Callable[[np.ndarray], np.ndarray] | None = None,
          warp: Callable[[np.ndarray], np.ndarray] | None = None, times: tuple[float, ...] = (0.0, 1.0)) -> Field:
    """A field that grows linearly in time from rest to u(X), p(X) at time 1."""
    X, conn = mesh(kind, n, warp)
    t = np.array(times)
    return Field(X, blocks_of(X, [(kind, conn)]), t, t[:, None, None] * u(X),
                 None if p is None else t[:, None] * p(X))


class Polynomial:
    """A random vector polynomial of a degree, with its derivatives."""

    def __init__(self, degree: int, seed: int = 0, components: int = 3) -> None:
        from febkit.coupling.derivatives import COUNT, TERMS

        self.terms = TERMS[:COUNT[degree]]
        self.c = np.random.default_rng(seed).uniform(-0.3, 0.3, (len(self.terms), components))

    def __call__(self, X: np.ndarray) -> np.ndarray:
        from febkit.coupling.derivatives import monomials

        return monomials(X, self.terms) @ self.c

    def derivative(self, X: np.ndarray, axes: tuple[int, ...]) -> np.ndarray:
        """d^axes of all components at X (m, 3): (m, components)."""
        from febkit.coupling.derivatives import monomials

        out = np.zeros((len(X), self.c.shape[1]))
        for k, t in enumerate(self.terms):
            left = list(t)
            if all(axes.count(a) <= left.count(a) for a in set(axes)):
                for a in axes:
                    left.remove(a)
                out += monomials(X, (tuple(left),)) * self.c[k]
        return out


@pytest.fixture
def places() -> np.ndarray:
    """Points inside the cube, clear of its surface."""
    return np.random.default_rng(5).uniform(-0.4, 0.4, (40, 3))

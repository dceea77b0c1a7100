"""Linear algebra of stacks of 3 x 3 matrices (..., 3, 3), where numpy would call LAPACK for each matrix."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .kernels.matrices import determinants, inverses, spectra

Floats = NDArray[np.float64]


def _flat(A: Floats) -> Floats:
    return np.ascontiguousarray(A, dtype=float).reshape(-1, 3, 3)


def det(A: Floats) -> Floats:
    """Determinants (...)."""
    out = np.empty(A.shape[:-2])
    determinants(_flat(A), out.reshape(-1))
    return out


def inv(A: Floats) -> Floats:
    """Inverses (..., 3, 3); not finite where a matrix is singular."""
    out = np.empty(A.shape)
    inverses(_flat(A), out.reshape(-1, 3, 3))
    return out


def eigh(A: Floats) -> tuple[Floats, Floats]:
    """Eigenvalues (..., 3), ascending, and eigenvectors (..., 3, 3; columns) of symmetric matrices."""
    values, vectors = np.empty(A.shape[:-1]), np.empty(A.shape)
    spectra(_flat(A), values.reshape(-1, 3), vectors.reshape(-1, 3, 3))
    return values, vectors


def eigvalsh(A: Floats) -> Floats:
    """Eigenvalues (..., 3) of symmetric matrices, ascending."""
    return eigh(A)[0]

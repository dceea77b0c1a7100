"""What a hydraulic permeability is."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ..law import Floats, Law, PoreCollapse
from ..points import Points
from ..record import variable_record

NO_TANGENT = np.empty((0, 6, 6))


@variable_record
class Permeability(Law):
    """Spatial permeability K (length^4 / force / time), flux w = -K grad p.

    ``permeability(pts, phi_r, K, dK)`` *adds* K to ``K`` (n, 6) and, unless ``dK`` is None, its strain
    tangent to ``dK`` (n, 6, 6): the fourth-order tensor D of minor symmetry with, for a velocity
    gradient whose symmetric part is e, and K' the rate of K that it causes,

        D : e = K tr e + K' - (grad v) K - K (grad v)^T     (D = J^-1 push-forward of 2 d(J F^-1 K F^-T)/dC),

    so that the rate of J grad a . K grad b at fixed nodal a, b is J grad a . (D : e) grad b. Rows of
    ``dK`` are components of K, columns of e; D has no major symmetry in general.
    (FEBio Theory Manual, section "Weak formulation for biphasic materials".)

    ``phi_r`` (1|n,) is the referential solid volume fraction. ``strain_dependent`` is False where FEBio
    leaves the tangent out (constant K): the caller may pass ``dK=None`` and keep a symmetric tangent.
    Raises :class:`PoreCollapse` where a law needs open pores and J <= phi_r.
    """

    strain_dependent: ClassVar[bool] = True

    def permeability(self, pts: Points, phi_r: Floats, K: Floats, dK: Floats | None) -> None:
        raise NotImplementedError


def open_pores(pts: Points, phi_r: Floats) -> None:
    """Raise :class:`PoreCollapse` for the first point with J <= phi_r."""
    closed = np.less_equal(pts.J, phi_r)
    if closed.any():
        i = int(np.argmax(closed))
        raise PoreCollapse(int(pts.e[i]), float(pts.J[i]), float(np.broadcast_to(phi_r, pts.J.shape)[i]))


def wanted(dK: Floats | None) -> Floats:
    """The tangent as kernels take it: without rows where none is wanted."""
    return NO_TANGENT if dK is None else dK

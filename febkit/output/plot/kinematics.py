"""Measures of strain, stretch and rate at integration points: (m, g, 6) of symmetric tensors, else (m, g[, 9]).

FEBio theory manual, "Kinematics"; Bonet & Wood, Nonlinear Continuum Mechanics, chapter 4.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .base import Floats, Part, at_nodes, mean, of_solids, register, shared, voigt

I = np.eye(3)


def gradient(part: Part) -> Floats:
    """Deformation gradient F (m, g, 9) by rows."""
    return part.g.F.reshape(part.g.m, part.g.g, 9)


@shared
def right(part: Part) -> Floats:
    """C = F^T F (m, g, 3, 3)."""
    return np.einsum("egki,egkj->egij", part.g.F, part.g.F)


@shared
def left(part: Part) -> Floats:
    """B = F F^T (m, g, 3, 3)."""
    return np.einsum("egik,egjk->egij", part.g.F, part.g.F)


@shared
def right_spectrum(part: Part) -> tuple[Floats, Floats]:
    """Squared principal stretches (m, g, 3) and principal directions, as columns, of C."""
    return np.linalg.eigh(right(part))


@shared
def left_spectrum(part: Part) -> tuple[Floats, Floats]:
    """Squared principal stretches and principal directions of B."""
    return np.linalg.eigh(left(part))


def of_stretch(
    spectrum: Callable[[Part], tuple[Floats, Floats]], f: Callable[[Floats], Floats]
) -> Callable[[Part], Floats]:
    """sum_i f(lambda_i) n_i n_i over principal stretches and directions."""

    def tensor(part: Part) -> Floats:
        w, n = spectrum(part)
        return voigt(np.einsum("egik,egk,egjk->egij", n, f(np.sqrt(w)), n))

    return tensor


def lagrange(part: Part) -> Floats:
    """E = (C - I) / 2."""
    return voigt(0.5 * (right(part) - I))


def infinitesimal(part: Part) -> Floats:
    """e = (F + F^T) / 2 - I."""
    return voigt(0.5 * (part.g.F + np.swapaxes(part.g.F, -1, -2)) - I)


def almansi(part: Part) -> Floats:
    """(I - B^-1) / 2."""
    return voigt(0.5 * (I - np.linalg.inv(left(part))))


@shared
def velocity_gradient(part: Part) -> Floats:
    """L = (F - F_old) F^-1 / dt over the last time step (m, g, 3, 3), zero before the first.

    The inverse is that of the state within the step at which stresses are taken (rhoi).
    """
    g, s = part.g, part.state
    if not s.dt > 0:
        return np.zeros_like(g.F)
    old, J = np.empty_like(g.F), np.empty_like(g.J)
    g.deform(s.u_old, old, J)
    system = part.run.system
    end = g.F
    if system is not None and system.alphaf != 1.0:
        end = np.empty_like(g.F)
        g.deform(s.u, end, J)
    return np.asarray((end - old) @ np.linalg.inv(g.F) / s.dt)


def rate(part: Part) -> Floats:
    """D = (L + L^T) / 2."""
    L = velocity_gradient(part)
    return voigt(0.5 * (L + np.swapaxes(L, -1, -2)))


register("deformation gradient", mean(gradient))
register("Lagrange strain", mean(lagrange))
register("infinitesimal strain", mean(of_solids(infinitesimal)))
register("Almansi strain", mean(almansi))
register("right Cauchy-Green", mean(lambda part: voigt(right(part))))
register("left Cauchy-Green", mean(lambda part: voigt(left(part))))
register("right stretch", mean(of_stretch(right_spectrum, lambda x: x)))
register("left stretch", mean(of_stretch(left_spectrum, lambda x: x)))
register("right Hencky", mean(of_stretch(right_spectrum, np.log)))
register("left Hencky", mean(of_stretch(left_spectrum, np.log)))
register("rate of deformation", mean(rate))
register("relative volume", mean(lambda part: part.g.J))
register("nodal strain", at_nodes(of_solids(lagrange)))

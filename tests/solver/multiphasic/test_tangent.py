"""The tangent of a mixture against central differences of its residual, on one distorted element."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from febkit.solver import permeabilities, reactions, solubilities
from febkit.solver.multiphasic.tangent import point_tangent
from helpers.mixture_element import Element, Mixture, Wells, bound, mixture, rate, solute

CONST = permeabilities.load("perm-const-iso")(perm=0.4)
HOLMES_MOW = permeabilities.load("perm-Holmes-Mow")(perm=0.4, M=0.3, alpha=1.3)
ALBRO = {"free_diff": 1.3, "cdinv": 0.3, "alphad": 0.5}
REF = {"free_diff": 1.3, "diff0": 1.1, "diff1": 0.3, "diff2": 0.2, "M": 0.4, "alpha": 1.1}


def ions(*charges: int, diffusivity: str = "diff-const-iso", **parameters: Any) -> tuple:
    return tuple(solute(i, z, diffusivity, **parameters) for i, z in enumerate(charges))


def action(kind: str, reactants: tuple, products: tuple, **more: Any) -> Any:
    v = [np.array(q, dtype=float) for q in (reactants, products)]
    return reactions.load(kind)(*v, 0.2, rate(), *([rate()] if "reversible" in kind else []), **more)


def errors(mix: Mixture, steady: bool = False, consistent: bool = False, passes: int = 1) -> dict[str, float]:
    """Largest errors of the blocks (rows, columns), relative to the largest entry of the block."""
    e = Element(mix, steady)
    x = e.state()
    e.force(x, passes)
    D, K = e.differences(x, passes=passes), e.tangent(x, passes, consistent)
    out = {}
    for r in "upc":
        for c in "upc":
            true = e.block(D, r, c)
            out[r + c] = float(np.abs(e.block(K, r, c) - true).max() / np.abs(true).max())
    return out


MIXTURES = {
    "constant": mixture(ions(1, -1)),
    "neutral": mixture(ions(1, -1), neutral=True),
    "one solute": mixture(ions(0), fixed_charge=mixture(()).phi0),
    "divalent": mixture(ions(2, -1, 0), permeability=CONST),
    "Albro": mixture(ions(1, -1, diffusivity="diff-Albro-iso", **ALBRO)),
    "referential": mixture(ions(1, -1, diffusivity="diff-ref-iso", **REF)),
    "orthotropic": mixture(ions(1, -1, diffusivity="diff-const-ortho", free_diff=1.0, diff=(0.3, 0.5, 0.7))),
    "forward": mixture(ions(1, -1, 0), reactions=(action("mass-action-forward", (1, 1, 0), (0, 0, 1)),)),
    "reversible": mixture(ions(1, -1, 0), reactions=(action("mass-action-reversible", (1, 1, 0), (0, 0, 2)),)),
    "effective": mixture(ions(1, -1, 0), reactions=(action("mass-action-reversible-effective", (1, 1, 0), (0, 0, 1)),)),
    "enzyme": mixture(ions(1, -1, 0), reactions=(action("Michaelis-Menten", (0, 0, 1), (0, 0, 0), Km=0.4),)),
    "independent": mixture(ions(1, -1, 0), reactions=(action("concentration-independent", (1, 1, 0), (0, 0, 1)),)),
}


@pytest.mark.parametrize("steady", [False, True], ids=["transient", "steady"])
@pytest.mark.parametrize("name", MIXTURES)
def test_rows_of_u_and_columns_of_p_and_c_are_exact(name: str, steady: bool) -> None:
    """A steady state with reactions is left out: there FEBio's supply of solutes and its tangent differ."""
    mix = MIXTURES[name]
    e = errors(mix, steady)
    exact = ["uu", "up", "uc", "pp", "cp"]
    exact += [] if steady and mix.reactions else ["pc", "cc"]
    assert {k: v for k, v in e.items() if k in exact and v > 1e-7} == {}


@pytest.mark.parametrize("neutral", [True, False], ids=["neutral", "charged"])
def test_the_consistent_tangent_is_exact_for_isotropic_laws(neutral: bool) -> None:
    laws = ions(1, -1, diffusivity="diff-Albro-iso", **(ALBRO | {"cdinv": 0.3 if neutral else 0.0}))
    e = errors(mixture(laws, permeability=HOLMES_MOW, neutral=neutral), consistent=True)
    assert {k: v for k, v in e.items() if v > 1e-7} == {}


def test_febio_s_tangent_is_not() -> None:
    """What the flag is for: it goes once FEBio's own becomes exact."""
    laws = ions(1, -1, diffusivity="diff-Albro-iso", **ALBRO)
    e = errors(mixture(laws, permeability=HOLMES_MOW, neutral=True))
    assert e["pu"] > 1e-3 and e["cu"] > 1e-3


def test_solid_bound_molecules_enter_by_their_rates() -> None:
    """A reaction makes and uses up solid-bound molecules: the tangent is that of small steps."""
    r = action("mass-action-forward", (1, 0, 1, 1), (0, 1, 0, 0))
    e = errors(mixture(ions(2, -1, 0), solid_bound=(bound(0, -1),), reactions=(r,)), passes=30)
    assert e["cc"] < 3e-3 and e["pc"] < 3e-3 and e["uc"] < 1e-2


def test_the_tangent_leaves_the_state_alone() -> None:
    """Manning's coefficients lag by an evaluation: one more within the tangent would move them."""
    law = solubilities.load("solub-Manning")(ksi=1.4, co_ion=1, solub=Wells())
    mix = mixture(tuple(replace(s, solubility=law) for s in ions(1, -1)))
    e = Element(mix)
    x = e.state()
    force, before = e.force(x), e.fields.snapshot()
    point_tangent(e.fields, slice(None), e.pts, np.zeros((e.pts.n, 6)), np.zeros((e.pts.n, 6, 6)), e.now)
    for name, kept in before.items():
        np.testing.assert_array_equal(getattr(e.fields, name), kept, err_msg=name)
    assert np.abs(e.force(x) - force).max() > 1e-6  # an evaluation does

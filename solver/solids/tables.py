"""Every material the solver has: one line each, checked by the ``register`` line at the foot of its file."""

from __future__ import annotations

#: table -> FEBio type -> "module:Class"
TABLES: dict[str, dict[str, str]] = {
    "solid": {
        "neo-Hookean": "neo_hookean:NeoHookean",
        "isotropic elastic": "isotropic_elastic:IsotropicElastic",
        "St.Venant-Kirchhoff": "st_venant_kirchhoff:StVenantKirchhoff",
        "natural neo-Hookean": "natural_neo_hookean:NaturalNeoHookean",
        "Holmes-Mow": "holmes_mow:HolmesMow",
        "porous neo-Hookean": "porous_neo_hookean:PorousNeoHookean",
        "coupled Mooney-Rivlin": "coupled_mooney_rivlin:CoupledMooneyRivlin",
        "Ogden unconstrained": "ogden_unconstrained:OgdenUnconstrained",
        "Mooney-Rivlin": "mooney_rivlin:MooneyRivlin",
        "Veronda-Westmann": "veronda_westmann:VerondaWestmann",
        "Ogden": "ogden:Ogden",
        "trans iso Mooney-Rivlin": "trans_iso_mooney_rivlin:TransIsoMooneyRivlin",
        "solid mixture": "solid_mixture:SolidMixture",
        "uncoupled solid mixture": "uncoupled_mixture:UncoupledMixture",
        "fiber-exp-pow": "fiber_exp_pow:FiberExpPow",
        "fiber-exp-pow-uncoupled": "fiber_exp_pow:FiberExpPowUncoupled",
        "fiber-exponential-power-law": "fiber_exp_pow:FiberExponentialPower",
        "fiber-pow-linear": "fiber_pow_linear:FiberPowLinear",
        "fiber-pow-linear-uncoupled": "fiber_pow_linear:FiberPowLinearUncoupled",
        "fiber-exp-linear": "fiber_exp_linear:FiberExpLinear",
        "uncoupled fiber-exp-linear": "fiber_exp_linear:FiberExpLinearUncoupled",
    },
    "fiber": {
        "fiber-exp-pow": "fiber_exp_pow:FiberExpPow",
        "fiber-exp-pow-uncoupled": "fiber_exp_pow:FiberExpPowUncoupled",
        "fiber-pow-linear": "fiber_pow_linear:FiberPowLinear",
        "fiber-pow-linear-uncoupled": "fiber_pow_linear:FiberPowLinearUncoupled",
        "fiber-exp-linear": "fiber_exp_linear:FiberExpLinear",
        "uncoupled fiber-exp-linear": "fiber_exp_linear:FiberExpLinearUncoupled",
    },
    "active": {
        "active_contraction": "active_contraction:ActiveContraction",
        "uncoupled active_contraction": "active_contraction:ActiveContraction",
    },
}

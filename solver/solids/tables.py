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
        "continuous fiber distribution": "continuous_fibers:ContinuousFibers",
        "continuous fiber distribution uncoupled": "continuous_fibers:ContinuousFibersUncoupled",
    },
    "fiber": {
        "fiber-exp-pow": "fiber_exp_pow:FiberExpPow",
        "fiber-exp-pow-uncoupled": "fiber_exp_pow:FiberExpPowUncoupled",
        "fiber-pow-linear": "fiber_pow_linear:FiberPowLinear",
        "fiber-pow-linear-uncoupled": "fiber_pow_linear:FiberPowLinearUncoupled",
        "fiber-exp-linear": "fiber_exp_linear:FiberExpLinear",
        "uncoupled fiber-exp-linear": "fiber_exp_linear:FiberExpLinearUncoupled",
    },
    "distribution": {
        "spherical": "distributions:Spherical",
        "circular": "distributions:Circular",
        "ellipsoidal": "distributions:Ellipsoidal",
        "elliptical": "distributions:Elliptical",
        "von-Mises-3d": "distributions:VonMises",
        "von-Mises-2d": "distributions:VonMisesPlane",
        "von-Mises-3d-two-axisym": "distributions:TwoVonMises",
        "structure-tensor": "distributions:StructureTensor",
    },
    "scheme": {
        "fibers-3d-fei": "schemes:Triangles",
        "fibers-3d-geodesic": "schemes:Geodesic",
        "fibers-2d-trapezoidal": "schemes:Trapezoidal",
        "fibers-3d-gauss": "schemes:Gauss",
        "fibers-3d-gkt": "schemes:Kronrod",
    },
    "active": {
        "active_contraction": "active_contraction:ActiveContraction",
        "uncoupled active_contraction": "active_contraction:ActiveContraction",
    },
}

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
    },
}

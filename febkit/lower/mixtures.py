"""Materials with solutes to solver records."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.model import Component, InputError, values
from febkit.model.species import Species, find, solid_bound, solutes
from febkit.solver import (
    diffusivities,
    osmotic_coefficients,
    permeabilities,
    physics,
    reaction_rates,
    reactions,
    solubilities,
    solute_supplies,
    supplies,
)
from febkit.solver.multiphasic.material import Mixture
from febkit.solver.multiphasic.species import SolidBound, Solute

from .context import Context
from .curves import Function, curve
from .laws import law

COMMON = {"phi0", "fluid_density", "solid", "permeability", "osmotic_coefficient", "solute", "density", "mat_axis"}
TAGS = {
    "biphasic-solute": COMMON,
    "triphasic": COMMON | {"penalty", "fixed_charge_density"},
    "multiphasic": COMMON
    | {"penalty", "fixed_charge_density", "solvent_supply", "solid_bound", "reaction", "membrane_reaction"},
}


def multiphasic(ctx: Context, spec: Component, part: str) -> Any:
    """The physics of a biphasic-solute, triphasic or multiphasic material; None where it is refused."""
    kind = spec.type or ""
    ctx.check_tags(spec, TAGS[kind])
    reader = _Reader(ctx, spec, part)
    mixture = reader.mixture()
    return None if mixture is None else physics.load("multiphasic")(mixture)


def attach(ctx: Context, spec: Component, mixture: Mixture, solid: Any) -> None:
    """Solids that go by a solid-bound molecule find it in the mixture, rate laws the solid that they go by."""
    names = [b.name for b in mixture.solid_bound]
    for node in solid.walk():
        if hasattr(node, "sbm"):
            named = find(solid_bound(ctx.model), str(node.sbm), "solid-bound molecule", spec.where).name
            if named not in names:
                raise InputError(f'<sbm>: "{named}" is not in {spec.what}', spec.where)
            node.sbm = names.index(named)
    molar, m = np.array([b.molar_mass for b in mixture.solid_bound]), len(mixture.solutes)
    for leaf, reaction in zip(spec.all("reaction"), mixture.reactions):
        for law_ in reaction.rates:
            try:
                law_.attach(solid, reaction.reactants[m:], reaction.products[m:], molar)
            except ValueError as e:
                raise InputError(f"{leaf.what}: {e}", leaf.where) from None


class _Reader:
    """Reads one material."""

    def __init__(self, ctx: Context, spec: Component, part: str) -> None:
        self.ctx, self.spec, self.part, self.kind = ctx, spec, part, spec.type or ""
        self.all_solutes, self.all_bound = solutes(ctx.model), solid_bound(ctx.model)
        self.refused = len(ctx.refused)

    def mixture(self) -> Mixture | None:
        ctx, spec, part = self.ctx, self.spec, self.part
        self.named = [self._ref(c, "sol", self.all_solutes, "solute") for c in spec.all("solute")]
        bound = spec.all("solid_bound")
        self.bound_named = [self._ref(c, "sbm", self.all_bound, "solid-bound molecule") for c in bound]
        self._check_solutes()
        perm = law(ctx, spec.need("permeability"), permeabilities, part)
        osmotic = law(ctx, spec.need("osmotic_coefficient"), osmotic_coefficients, part, self._special())
        supply = spec.child("solvent_supply")
        taken = tuple(self._solute(c, s) for c, s in zip(spec.all("solute"), self.named))
        made = tuple(self._bound(c, s) for c, s in zip(bound, self.bound_named))
        done = tuple(r for r in (self._reaction(c) for c in spec.all("reaction")) if r is not None)
        crossing = tuple(r for r in (self._membrane(c) for c in spec.all("membrane_reaction")) if r is not None)
        supply_law = None if supply is None else law(ctx, supply, supplies, part)
        if len(ctx.refused) > self.refused:
            return None
        ctx.value(spec.child("fluid_density"), 0.0, part)  # a number; FEBio's balances do not have it
        R, T, Fc = (self._constant(k) for k in ("R", "T", "Fc"))
        return Mixture(
            perm, osmotic, taken, R, T, Fc,
            ctx.value(spec.child("phi0"), 0.0, part),
            ctx.value(spec.child("fixed_charge_density"), 0.0, part), spec.float("penalty", 1.0),
            self.kind == "biphasic-solute", supply_law, made, done, crossing, len(self.all_solutes),
            len(self.all_bound),
        )  # fmt: skip

    def _ref(self, c: Component, attribute: str, species: tuple[Species, ...], what: str) -> Species:
        ref = c.attrs.get(attribute) or c.name or ""
        return find(species, ref, what, c.where)

    def _constant(self, name: str) -> float:
        """R, T, and Fc where there are ions, must be positive."""
        v = float(self.ctx.model.constants.get(name, 0.0))
        charged = any(s.charge for s in self.named) and self.kind != "biphasic-solute"
        if v <= 0.0 and (name != "Fc" or charged):
            raise InputError(f"{self.spec.what} needs a positive <{name}> in <Globals><Constants>", self.spec.where)
        return v

    def _check_solutes(self) -> None:
        """One solute in biphasic-solute, two ions of opposite unit charge in triphasic; each once."""
        spec, charges = self.spec, [s.charge for s in self.named]
        if self.kind == "biphasic-solute" and len(charges) != 1:
            raise InputError(f"{spec.what} takes one <solute>, not {len(charges)}", spec.where)
        if self.kind == "triphasic" and sorted(charges) != [-1, 1]:
            raise InputError(
                f"{spec.what} takes two <solute>s of charge numbers +1 and -1, not {charges}", spec.where
            )
        for what, named in (("solute", self.named), ("solid-bound molecule", self.bound_named)):
            twice = {s.name for s in named if named.count(s) > 1}
            if twice:
                raise InputError(f'{spec.what}: the {what} "{min(twice)}" is there twice', spec.where)

    # ---- species ------------------------------------------------------------------------------------
    def _special(self) -> Any:
        """How laws of solutes read what is no number: the co-ion, a rate's solute, functions of one variable."""

        def read(c: Component) -> Any:
            if c.tag in ("co_ion", "sol"):
                return self._local(c)
            if c.tag == "D" and not c.as_float():
                return 0.0
            if c.tag in ("solub", "osmc"):
                return Function(curve(self.ctx, c))
            return None

        return read

    def _local(self, c: Component) -> int:
        """Place of a solute among those of the material."""
        s = find(self.all_solutes, c.text.strip(), "solute", c.where)
        if s not in self.named:
            raise InputError(f'<{c.tag}>: the solute "{s.name}" is not in {self.spec.what}', c.where)
        return self.named.index(s)

    def _solute(self, c: Component, s: Species) -> Solute:
        ctx, part = self.ctx, self.part
        ctx.check_tags(c, {"diffusivity", "solubility", "supply", "charge_number", "molar_mass", "density"})
        diffusivity = law(ctx, c.need("diffusivity"), diffusivities, part, self._special())
        solubility = law(ctx, c.need("solubility"), solubilities, part, self._special())
        supply = c.child("supply")
        made = None
        if supply is not None and self.kind == "biphasic-solute":
            made = law(ctx, supply, solute_supplies, part)
        elif supply is not None:
            ctx.refuse(f"<supply> of a solute of a {self.kind} material", supply.where)
        self._check_diffusivity(c, diffusivity)
        return Solute(s.name, s.index, diffusivity, solubility, s.charge, s.molar_mass, s.density, made)

    @staticmethod
    def _check_diffusivity(c: Component, given: Any) -> None:
        """free_diff must not be less than diff."""
        free, diff = getattr(given, "free_diff", None), getattr(given, "diff", None)
        if free is None or diff is None:
            return
        parts = diff if isinstance(diff, tuple) else (diff,)
        if all(v.constant for v in (free, *parts)):
            numbers = [float(v(0.0, np.zeros((1, 3)))[0]) for v in (free, *parts)]
            if numbers[0] < max(numbers[1:]):
                leaf = c.need("diffusivity")
                raise InputError(
                    f"<diffusivity>: free_diff ({numbers[0]:g}) must not be less than diff ({max(numbers[1:]):g})",
                    leaf.where,
                )

    def _bound(self, c: Component, s: Species) -> SolidBound:
        ctx = self.ctx
        ctx.check_tags(c, {"rho0", "rhomin", "rhomax", "charge_number", "molar_mass", "density"})
        rho0 = ctx.value(c.child("rho0"), 0.0, self.part)
        return SolidBound(
            s.name, s.index, s.charge, s.molar_mass, s.density, rho0, c.float("rhomin", 0.0), c.float("rhomax", 0.0)
        )

    # ---- reactions ----------------------------------------------------------------------------------
    def _reaction(self, c: Component) -> Any:
        ctx = self.ctx
        if c.type is None or not reactions.known(c.type):
            ctx.refuse(f'<reaction type="{c.type}">', c.where)
            return None
        own = {"Km", "c0"} if c.type == "Michaelis-Menten" else set()
        rates = {"forward_rate", "reverse_rate"} if "reversible" in c.type else {"forward_rate"}
        ctx.check_tags(c, {"Vbar", "override_vbar", "vR", "vP", *own, *rates})
        v = [self._stoichiometry(c, tag) for tag in ("vR", "vP")]
        net = v[1] - v[0]
        everyone = [*self.named, *self.bound_named]
        charge = sum(n * s.charge for n, s in zip(net, everyone))
        if charge:
            raise InputError(f"{c.what} makes a net charge of {charge:+g}: it must be neutral", c.where)
        volume = float(sum(n * s.molar_mass / s.density for n, s in zip(net, everyone)))
        leaf = c.child("Vbar")
        read = {tag: law(ctx, c.need(tag), reaction_rates, self.part, self._special()) for tag in sorted(rates)}
        if any(r is None for r in read.values()):
            return None
        make: Any = reactions.load(c.type)
        try:
            return make(
                *v, volume if leaf is None else leaf.as_float(), read["forward_rate"], read.get("reverse_rate"),
                **{k: c.float(k, 0.0) for k in own},
            )  # fmt: skip
        except ValueError as e:
            raise InputError(f"{c.what}: {e}", c.where) from None

    def _membrane(self, c: Component) -> Any:
        """A reaction of a shell with what is on its faces: e in front, i behind."""
        from febkit.solver import membrane_reactions

        ctx = self.ctx
        if c.type is None or not membrane_reactions.known(c.type):
            ctx.refuse(f'<membrane_reaction type="{c.type}">', c.where)
            return None
        rates = ["forward_rate", "reverse_rate"] if "reversible" in c.type else ["forward_rate"]
        ctx.check_tags(c, {"Vbar", "override_vbar", "vR", "vP", "vRe", "vPe", "vRi", "vPi", *rates})
        v = [self._stoichiometry(c, tag) for tag in ("vR", "vP")]
        out = [np.array([self._outside(c, f"v{s}{side}") for side in "ei"]) for s in "RP"]
        net, outside = v[1] - v[0], (out[1] - out[0]).sum(axis=0)
        species = [*zip(net, (*self.named, *self.bound_named)), *zip(outside, self.all_solutes)]
        charge = sum(n * s.charge for n, s in species)
        if charge:
            raise InputError(f"{c.what} makes a net charge of {charge:+g}: it must be neutral", c.where)
        leaf, volume = c.child("Vbar"), float(sum(n * s.molar_mass / s.density for n, s in species))
        read = [self._membrane_rate(c.need(tag)) for tag in rates]
        if any(r is None for r in read):
            return None
        make: Any = membrane_reactions.load(c.type)
        charges = np.array([float(s.charge) for s in self.all_solutes])
        return make(
            *v, volume if leaf is None else leaf.as_float(), *read, reactants_outside=out[0], products_outside=out[1],
            charges=charges,
        )  # fmt: skip

    def _membrane_rate(self, c: Component) -> Any:
        """A rate; that of ion channels knows its ion's charge, and the model's constants."""
        from febkit.solver import membrane_rates

        out = law(self.ctx, c, membrane_rates, self.part, self._crossing)
        if hasattr(out, "z"):
            ion = self.all_solutes[out.sol]
            if not ion.charge:
                raise InputError(f'<{c.tag} type="{c.type}">: the solute "{ion.name}" is no ion', c.where)
            Fc = float(self.ctx.model.constants.get("Fc", 0.0))
            if Fc <= 0.0:
                raise InputError(f"{c.what} needs a positive <Fc> in <Globals><Constants>", c.where)
            out.z, out.RT, out.Fc = float(ion.charge), self._constant("R") * self._constant("T"), Fc
        return out

    def _crossing(self, c: Component) -> Any:
        """What rates of membrane reactions read that is no number: a solute of the model, a bound molecule."""
        if c.tag == "sol":
            return find(self.all_solutes, c.text.strip(), "solute", c.where).index
        if c.tag == "sbm":
            s = find(self.all_bound, c.text.strip(), "solid-bound molecule", c.where)
            if s not in self.bound_named:
                raise InputError(f'<sbm>: the solid-bound molecule "{s.name}" is not in {self.spec.what}', c.where)
            return self.bound_named.index(s)
        return None

    def _outside(self, c: Component, tag: str) -> np.ndarray:
        """Coefficients (M,) of the model's solutes on a face."""
        out = np.zeros(len(self.all_solutes))
        for leaf in c.all(tag):
            s = self._species(leaf)
            if s not in self.all_solutes:
                raise InputError(f'<{tag}>: "{s.name}" is bound to the solid, not a solute', leaf.where)
            out[s.index] = self._coefficient(leaf, tag)
        return out

    @staticmethod
    def _coefficient(leaf: Component, tag: str) -> int:
        n = (leaf.child(tag) or leaf).as_int()
        if n < 0:
            raise InputError(f"<{tag}> must not be negative, not {n}", leaf.where)
        return n

    def _stoichiometry(self, c: Component, tag: str) -> np.ndarray:
        """Coefficients (m + b,) of the material's solutes and solid-bound molecules."""
        everyone = [*self.named, *self.bound_named]
        out = np.zeros(len(everyone))
        for leaf in c.all(tag):
            s = self._species(leaf)
            if s not in everyone:
                raise InputError(f'<{tag}>: "{s.name}" is not in {self.spec.what}', leaf.where)
            out[everyone.index(s)] = self._coefficient(leaf, tag)
        return out

    def _species(self, leaf: Component) -> Species:
        """Solutes and solid-bound molecules share the names of <vR species="...">; the ids of the second follow."""
        if "sol" in leaf.attrs:
            return find(self.all_solutes, leaf.attrs["sol"], "solute", leaf.where)
        if "sbm" in leaf.attrs:
            return find(self.all_bound, leaf.attrs["sbm"], "solid-bound molecule", leaf.where)
        ref, n = leaf.attrs.get("species", "").strip(), len(self.all_solutes)
        everyone = {s.name: s for s in (*self.all_bound, *self.all_solutes)}
        if ref not in everyone and ref.isdigit() and 1 <= int(ref) <= n + len(self.all_bound):
            return (*self.all_solutes, *self.all_bound)[int(ref) - 1]
        if ref not in everyone:
            message = f'there is no solute or solid-bound molecule "{ref}"'
            raise InputError(message + values.near(ref, everyone), leaf.where)
        return everyone[ref]


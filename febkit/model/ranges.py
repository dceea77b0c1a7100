"""What values FEBio 4.11 admits for a parameter, from its class registrations and their checks (facts, not code)."""

from __future__ import annotations

import math
import re
from functools import cache

from febkit.record import value_record

# a line per type: parameters and what they must be; "(control)" and "(solver)" stand for all types of these
TABLE = r"""
2D fiber neo-Hookean: v[-1,0.5)
2D trans iso Mooney-Rivlin: k>=0 c1>0 lam_max>=1
2D trans iso Veronda-Westmann: k>=0 c1>0 c2>0
Arruda-Boyce unconstrained: ksi>0 N>0 n_term[3,30] kappa>0
Arruda-Boyce: k>=0 mu>0 N>0
BFGS: max_buffer_size>=0 cmax>=0
biphasic-solute: phi0[0,1] fluid_density>=0
biphasic: phi0[0,1] fluid_density>=0 tau>=0
Broyden: max_buffer_size>=0 cmax>=0
Carreau-Yasuda viscous solid: mu0>=0 mui>=0 lambda>=0 n>=0 a>=2
Carter-Hayes (old): c>0 gamma>=0 v[-1,0.5)
Carter-Hayes: E0>0 rho0>0 gamma>=0 v[-1,0.5)
CDF gamma: Dmax[0,1] alpha>0 mu>=0
CDF log-normal: Dmax[0,1] mu>0 sigma>0
CDF quintic: Dmax[0,1] mumin>=0
CDF Simo: Dmax[0,1] a>0 b[0,1]
CDF step: Dmax[0,1] mu>=0
CDF user: Dmax[0,1]
CDF Weibull: Dmax[0,1] alpha>=0 mu>=0
cell growth: phir>0 cr>0 ce>0
compressible Gent: G>0 K>0 Jm>0
constant reaction rate: k>=0
continuous fiber distribution uncoupled: k>=0
coupled Mooney-Rivlin: c1>0 k>0
coupled trans-iso Mooney-Rivlin: c1>0 lam_max>=1 k>0
coupled trans-iso Veronda-Westmann: c1>0 lambda>=1 k>0
coupled Veronda-Westmann: c1>0 k>0
cubic CLE: mu>=0
damage fiber exp-linear: t0>=0 Dmax[0,1] beta_s>0 gamma_max>=0 c3>=0 c4>=0 c5>=0 lambda>0
damage fiber exponential: t0>=0 Dmax[0,1] beta_s>0 gamma_max>=0 k1>=0 k2>0 kappa[0,1/3]
damage fiber power: t0>=0 Dmax[0,1] beta_s>0 gamma_max>=0 a1>=0 a2>1 kappa[0,2/3]
damage Mooney-Rivlin: k>=0 c1>0
damage neo-Hookean: E>0 v[-1,0.5) a>=0 b[0,1]
damage trans iso Mooney-Rivlin: k>=0 c1>0 c4>0
DC Drucker shear stress: c[-27/8,9/4]
diff-Albro-iso: free_diff>=0 cdinv>=0 alphad>=0
diff-const-iso: free_diff>=0 diff>=0
diff-const-ortho: free_diff>0 diff>=0
diff-ref-iso: free_diff>=0 diff0>=0 diff1>=0 diff2>=0 M>=0 alpha>=0
discrete contact: altol>=0 gaptol>=0 penalty>=0
Donnan equilibrium: phiw0(0,1] bosm>=0 Phi>=0
EFD Mooney-Rivlin: k>=0
EFD uncoupled: k>=0 beta>=2 ksi>=0
EFD Veronda-Westmann: k>=0
elastic membrane: E>0 v[-1,0.5)
ellipsoidal fiber distribution (old): beta>=2 ksi>=0
ellipsoidal fiber distribution: beta>=2 ksi>=0
ellipsoidal: spa>=0
elliptical: spa1>=0 spa2>=0
exp-sed reaction rate: Psi0!=0
fiber neo-Hookean: E>0 v[-1,0.5)
fiber-CDF-uncoupled: E>=0 k>=0
fiber-CDF: E>=0
fiber-entropy-chain: N>=0 ksi>=0 mu>=0 n_term>=3
fiber-exp-linear: c3>=0 c4>=0 c5>=0 lambda>=1
fiber-exp-pow sbm: alpha>=0 beta>=2 ksi0>=0 rho0>=0 gamma>=0
fiber-exp-pow-linear: E>=0 alpha>=0 beta>=2 lam0>1
fiber-exp-pow-uncoupled: alpha>=0 beta>=2 ksi>=0 mu>=0 k>=0
fiber-exp-pow: alpha>=0 beta>=2 ksi>=0 mu>=0 lam0>=1
fiber-exponential-power-law-uncoupled: k>=0 alpha>=0 beta>=2 mu>=0
fiber-exponential-power-law: alpha>=0 beta>=2 ksi>=0 mu>=0 lam0>=1
fiber-Kiousis-uncoupled: k>=0
fiber-natural-NH: ksi>=0 lam0>=1
fiber-NH-uncoupled: mu>=0 k>=0
fiber-NH: mu>=0
fiber-pow-linear sbm: E0>=0 lam0>1 beta>=2 rho0>=0 gamma>=0
fiber-pow-linear-uncoupled: E>0 lam0>1 beta>=2 k>=0
fiber-pow-linear: E>0 lam0>1 beta>=2
fiber-pow: ksi>0 beta>=2
fibers-2d-trapezoidal: nth>0
fibers-3d-fei: resolution{0..20,34,60,74,196,210,396,410,596,610,796,810,996,1010,1196,1210,1396,1410,1596,1610,1796}
fibers-3d-gauss: nph[1,10] nth>0
fibers-3d-geodesic: resolution{0,1}
fibers-3d-gkt: nph{7,11,15,19,23,27} nth>0
Fung orthotropic: k>=0 E1>0 E2>0 E3>0 G12>=0 G23>=0 G31>=0 c>0
Fung-ortho-compressible: E1>0 E2>0 E3>0 c>0 k>0
Gent: k>=0 G>0 Jm>0
HGO unconstrained: c>=0 k1>=0 k2>=0 kappa[0,1/3] k>=0
HGO-coronary: k>=0
Holmes-Mow: E>0 v[-1,0.5) beta>=0
Holzapfel-Gasser-Ogden: k>=0 c>=0 k1>=0 k2>=0 kappa[0,1/3]
Huiskes reaction rate: psi0>=0 D>=0
Huiskes-supply: D>=0
incomp neo-Hookean: k>=0 G>0
isotropic elastic: E>0 v[-1,0.5)
isotropic Hencky: E>0 v[-1,0.5)
linear spring: E>0
linear truss: density>0 E>0 v[-1,0.5]
lung: E>0 v>0 c1>0 c3>0 d1>0 d3>0
membrane constant reaction rate: k>=0
membrane ion channel reaction rate: g>=0
membrane voltage-gated reaction rate: a>=0 b>=0 c>=0 d>=0
Mooney-Rivlin AD: k>=0
Mooney-Rivlin von Mises Fibers: k>=0
Mooney-Rivlin: k>=0
multiphasic-multigeneration: phi0[0,1] fluid_density>=0 penalty>=0 gen_time>0
muscle material: k>=0
natural neo-Hookean: E>=0 v[-1,0.5)
neo-Hookean AD: E>0 v[-1,0.5)
neo-Hookean: E>0 v[-1,0.5)
Newtonian viscous solid uncoupled: k>=0 kappa>=0 mu>=0
Newtonian viscous solid: kappa>=0 mu>=0
Nims reaction rate: cc>0 cr>0 trel>=0
node-on-node: a>0 b>0
Ogden unconstrained: m1!=0 m2!=0 m3!=0 m4!=0 m5!=0 m6!=0
Ogden: k>=0 m1!=0 m2!=0 m3!=0 m4!=0 m5!=0 m6!=0
orthotropic CLE: mu1>=0 mu2>=0 mu3>=0
orthotropic elastic: E1>0 E2>0 E3>0 G12>=0 G23>=0 G31>=0
osm-coef-const: osmcoef>=0
osm-coef-Manning: ksi>=0
osmotic virial expansion: phiw0[0,1] cr>=0
perfect osmometer: phiw0[0,1] iosm>=0 bosm>=0
perm-const-iso: perm>=0
perm-exp-iso: perm>=0 M>=0
perm-Holmes-Mow: perm>=0 M>=0 alpha>=0
perm-ref-iso: perm0>=0 perm1>=0 perm2>=0 M>=0 alpha>=0
perm-ref-ortho: perm0>=0 M0>=0 alpha0>=0
perm-ref-trans-iso: perm0>=0 perm1T>=0 perm1A>=0 perm2T>=0 perm2A>=0 M0>=0 MT>=0 MA>=0 alpha0>=0 alphaT>=0 alphaA>=0
PFC math: nf>0 e0>0 emax>0
PFC paper: Y0>=0 Ymax>=0 w0[0,1] we[0,1] nf>0 r(0,1]
porous neo-Hookean: E>0 phi0[0,1]
reactive fatigue: k0>=0 beta>=0
reactive plastic damage: rtol>=0
reactive plasticity: rtol>=0
reactive viscoelastic: wmin[0,1] kinetics[1,2] trigger[0,2] emin>=0
recruitment exponential: alpha>=0 mu0>=0 scale>0
recruitment gamma: alpha>0 mu>=0 max>=0
recruitment log-normal: mu>0 sigma>0 max>=0
recruitment polynomial: mu0>=0
recruitment power: scale>0
recruitment quintic: mumin>=0 max>=0
recruitment Weibull: alpha>=0 mu>=0 max>=0
relaxation-Carreau: tau0>0 lambda>=0 n>0
relaxation-CSexp: tau>0
relaxation-exp-distortion: tau0>0 tau1>=0 alpha>=0
relaxation-exponential: tau>0
relaxation-Fung: tau1>0 tau2>0
relaxation-Malkin-distortion: t1c0>0 t1s0>0 t2c0>0 t2s0>0 beta>0
relaxation-Malkin: tau1>0 tau2>0 beta>=1
relaxation-Park-distortion: tau0>0 tau1>=0 beta0>0 beta1>=0 alpha>=0
relaxation-Park: tau>0 beta>0
relaxation-power-distortion: tau0>0 tau1>=0 beta0>0 beta1>=0 alpha>=0
relaxation-power: tau>0 beta>0
relaxation-Prony: t1>=0 t2>=0 t3>=0 t4>=0 t5>=0 t6>=0 g1[0,1] g2[0,1] g3[0,1] g4[0,1] g5[0,1] g6[0,1]
rigid body: E>=0 v[-1,0.5)
Ruberti reaction rate: sigma>=0
scaled elastic: scale[0,1]
scaled uncoupled: k>=0 scale[0,1]
Shenoy: mu>=0 k>=0 Ef>=0 lam_c>=1 lam_t!=0 n>=1 m>=1
solub-const: solub>=0
solub-Manning: ksi>=0
spherical fiber distribution sbm: alpha>=0 beta>=2 ksi0>=0 rho0>=0 gamma>=0
spherical fiber distribution: alpha>=0 beta>=2 ksi>=0
St.Venant-Kirchhoff: E>0 v[-1,0.5)
supply-binding: kf>0 kr>=0 Rtot>=0
supply-Michaelis-Menten: Vmax>=0 Km>0
supply-synthesis-binding: kf>0 kr>=0 Rtot>=0
TC nonlinear orthotropic: k>=0 beta>=2 ksi>=0
tendon material: k>=0
tension-only linear spring: E>0
trace-free neo-Hookean: mu>0
trans iso Mooney-Rivlin: k>=0
trans iso MR-Estrada: k>=0
trans iso Veronda-Westmann: k>=0
triphasic: phi0[0,1] fluid_density>=0 penalty>=0
uncoupled active contraction: k>=0
uncoupled active fiber stress: k>=0
uncoupled elastic damage: k>=0
uncoupled fiber-entropy-chain: N>=0 ksi>=0 n_term>3 k>=0
uncoupled fiber-exp-linear: c3>=0 c4>=0 c5>=0 lambda>=1 k>=0
uncoupled Holmes-Mow: k>=0 mu>0 beta>=0
uncoupled hyperelastic: k>=0
uncoupled isotropic Lee-Sacks: k>=0
uncoupled prescribed fiber active contraction: k>=0
uncoupled prescribed isotropic active contraction: k>=0
uncoupled prescribed trans iso active contraction: k>=0
uncoupled prescribed uniaxial active contraction: k>=0
uncoupled prestrain elastic: k>=0
uncoupled reactive fatigue: k>=0 k0>=0 beta>=0
uncoupled reactive viscoelastic: k>=0 wmin[0,1] kinetics[1,2] trigger[0,2] emin>=0
uncoupled solid mixture: k>=0
uncoupled trans-iso hyperelastic: k>=0
uncoupled viscoelastic damage: k>=0
uncoupled viscoelastic: k>=0
Veronda-Westmann: k>=0 c1>0 c2>0
von-Mises plasticity: E>0 v[-1,0.5) Y>0 H>=0
von-Mises-2d: b>=0
von-Mises-3d-two-axisym: b>=0 cosg[0,1]
von-Mises-3d: b>=0
wrinkle Ogden: mu>0 alpha>=2
Yeoh: k>=0
(control): time_steps>=-1 step_size>=0 final_time>=0 plot_stride>0 output_stride>0
(solver): lstol>=0 lsmin>=0 lsiter>=0 max_refs>=0 min_residual>=0 max_residual>=0 dtol>=0 etol>=0 rtol>=0
"""

#: words for the numbers of an enumeration, by its tag; "(invalid)" keeps the first place, which no word may name
WORDS = {
    "kinetics": ("(invalid)", "type i", "type ii"),
    "trigger": ("any strain", "distortional", "dilatational"),
    "pressure_model": ("default", "nike3d", "abaqus", "abaqus (goh)"),
    "measure": ("elongation", "strain", "stretch"),
    "resolution": ("low", "high"),
}
_ITEM = re.compile(r"([A-Za-z_]\w*)(\S+)")
_SIGNS = {">": "more than", ">=": "at least", "!=": "other than"}


@value_record
class Range:
    """Numbers from ``least`` to ``most``, with these where ``closed`` says so; those of ``only``; all but ``never``."""

    said: str
    least: float = -math.inf
    most: float = math.inf
    closed: tuple[bool, bool] = (True, True)
    only: frozenset[float] = frozenset()
    never: float = math.nan

    def holds(self, v: float) -> bool:
        if self.only:
            return v in self.only
        above = v >= self.least if self.closed[0] else v > self.least
        below = v <= self.most if self.closed[1] else v < self.most
        return above and below and v != self.never


def _number(text: str) -> float:
    a, _, b = text.partition("/")
    return float(a) / float(b or 1)


def _range(text: str) -> Range:
    if text[0] == "{":
        words = text[1:-1].split(",")
        runs = [w.partition("..") for w in words]
        only = frozenset(float(v) for a, _, b in runs for v in range(int(a), int(b or a) + 1))
        return Range(f"one of {', '.join(words)}", only=only)
    if text[0] in "([":
        a, b = text[1:-1].split(",")
        closed = text[0] == "[", text[-1] == "]"
        return Range(f"in {text[0]}{a}, {b}{text[-1]}", _number(a), _number(b), closed)
    sign, number = (text[:2], text[2:]) if text[1] == "=" else (text[0], text[1:])
    said, v = f"{_SIGNS[sign]} {number}", _number(number)
    return Range(said, never=v) if sign == "!=" else Range(said, least=v, closed=(sign == ">=", True))


@cache
def _lines() -> dict[str, str]:
    rows = (line.partition(": ") for line in TABLE.strip().replace("\n  ", " ").split("\n"))
    return {name: items for name, _, items in rows}


@cache
def of(type_: str) -> dict[str, Range]:
    """Ranges of the parameters of a type, by tag; empty where FEBio admits all numbers."""
    items = _lines().get(type_, "").split()
    return {m[1]: _range(m[2]) for m in map(_ITEM.fullmatch, items) if m is not None}

"""One example of every solid of the table, with the laws it is known to break and why."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from febkit.solver.problem import Block, Problem, Step
from febkit.solver.rve import Rve
from febkit.solver.solids.registry import load, tables

from . import scenes


def direction(pts):
    return np.array([[1.0, 2.0, -0.5]])


def solid(name, **kw):
    return load("solid", name)(**kw)


def of(table, name, **kw):
    return load(table, name)(**kw)


def neo_hookean():
    return solid("neo-Hookean", E=2.0, v=0.3)


def mooney_rivlin():
    return solid("Mooney-Rivlin", c1=1.0, c2=0.2)


def curve(x):
    return 0.5 + x


def bell(x):
    return np.exp(-3.0 * (x - 1.1) ** 2)


def falling(x):
    return np.exp(-2.0 * x)


class Response:
    points = ((0.03, 0.05), (0.1, 0.09), (0.3, 0.12))


_EXP = dict(c3=0.3, c4=4.0, c5=2.0)
_ENG = dict(E1=1.0, E2=2.0, E3=3.0, G12=0.5, G23=0.7, G31=0.9, v12=0.2, v23=0.1, v31=0.15)
_CLE = dict(lp11=3.0, lp22=4.0, lp33=5.0, lm11=1.0, lm22=1.2, lm33=1.4, l12=0.3, l23=0.2, l31=0.1)
_HISTORY = "its tangent leaves out how history changes"
_SECANT = "its tangent is by forward differences"
_ACTIVE = "FEBio's tangent leaves the active tension out"
_GROWTH = "its tangent leaves out the growth of damage"

_TIRED = ("reactive fatigue", "uncoupled reactive fatigue", "reactive viscoelastic fatigue")
_DAMAGE = dict(
    t0=0.25, Dmax=0.8, beta_s=20.0, gamma_max=3.0, D2_a=0.02, D2_b=0.7, D2_c=0.05, D2_d=0.4, D3_inf=0.9, D3_g0=0.1,
    D3_rg=0.2, fiber=direction,
)  # fmt: skip

SIMPLE = {
    "damage fiber power": dict(a1=1.2, a2=2.4, kappa=0.2, **_DAMAGE),
    "damage fiber exponential": dict(k1=1.2, k2=0.4, kappa=0.1, **_DAMAGE),
    "damage fiber exp-linear": dict(c3=1.2, c4=4.0, c5=3.0, lambda_=1.1, **_DAMAGE),
    "damage trans iso Mooney-Rivlin": dict(
        c1=1.0, c2=0.2, c3=0.7, c4=0.9, Mbeta=0.3, Msmin=0.05, Msmax=2.0, Fbeta=0.4, Fsmin=0.02, Fsmax=1.5, k=10.0
    ),
    "von-Mises plasticity": dict(E=2.0, v=0.3, Y=0.1, H=0.3),
    "spherical fiber distribution sbm": dict(alpha=0.5, beta=2.3, ksi0=1.2, rho0=0.7, gamma=1.5),
    "damage neo-Hookean": dict(E=2.0, v=0.3, a=0.4, b=0.3),
    "damage Mooney-Rivlin": dict(c1=1.0, c2=0.2, beta=0.3, smin=0.05, smax=2.0, k=10.0),
    "Carreau-Yasuda viscous solid": dict(mu0=1.5, mui=0.2, lambda_=0.9, n=0.6, a=2.4),
    "lung": dict(E=2.0, v=0.3, c1=0.7, c3=0.9, d1=2.4, d3=3.0),
    "isotropic Lee-Sacks": dict(c0=1.0, c1=0.8, c2=0.6, k=5.0),
    "uncoupled isotropic Lee-Sacks": dict(c0=1.0, c1=0.8, c2=0.6, k=5.0),
    "polynomial": dict(c01=0.2, c02=0.3, c10=1.0, c11=0.1, c12=0.15, c20=0.25, c21=0.05, c22=0.07, D1=4.0, D2=3.0),
    "HGO-coronary": dict(rho=0.4, k1=1.0, k2=0.7, k=10.0, fiber=direction),
    "neo-Hookean AD": dict(E=2.0, v=0.3),
    "Mooney-Rivlin AD": dict(c1=1.0, c2=0.2, k=10.0),
    "neo-Hookean transiso": dict(Ep=1.0, Ez=3.0, vz=0.2, vp=0.3, gz=0.6),
    "trans iso MR-Estrada": dict(c1=1.0, c2=0.3, **_EXP, lam_max=1.05, k=10.0, fiber=direction),
    "fiber-exponential-power-law-uncoupled": dict(alpha=0.4, beta=2.5, ksi=1.0, mu=0.3, k=5.0, fiber=direction),
    "active fiber stress": dict(smax=1.5, activation=0.7, stl=bell, stv=falling),
    "uncoupled active fiber stress": dict(smax=1.5, activation=0.7, stl=bell, k=5.0),
    "uncoupled active contraction": dict(Tmax=1.0, ca0=2.0, camax=1.5, beta=2.0, l0=0.6, refl=1.2, k=5.0),
    "osmotic virial expansion": dict(phiw0=0.8, cr=0.3, c1=2.0, c2=0.5, c3=0.2),
    "2D fiber neo-Hookean": dict(E=2.0, v=0.3, a=(0.4, 0.7), active_contraction=0.8),
    "fiber neo-Hookean": dict(E=2.0, v=0.3, a=(0.4, 0.7, 0.2), active_contraction=0.01),
    "2D trans iso Veronda-Westmann": dict(c1=1.0, c2=0.8, **_EXP, lam_max=1.05, w=(1.0, 2.0), k=10.0),
    "spherical fiber distribution": dict(alpha=0.5, beta=2.3, ksi=1.2),
    "neo-Hookean": dict(E=2.0, v=0.3),
    "isotropic elastic": dict(E=2.0, v=0.3),
    "St.Venant-Kirchhoff": dict(E=2.0, v=0.3),
    "natural neo-Hookean": dict(E=2.0, v=0.3),
    "isotropic Hencky": dict(E=2.0, v=0.3),
    "Holmes-Mow": dict(E=2.0, v=0.3, beta=0.4),
    "porous neo-Hookean": dict(E=2.0, phi0=0.2),
    "coupled Mooney-Rivlin": dict(c1=1.0, c2=0.3, k=5.0),
    "coupled Veronda-Westmann": dict(c1=1.0, c2=0.8, k=5.0),
    "Ogden unconstrained": dict(cp=3.0, c1=1.0, m1=2.3, c2=0.4, m2=-1.7),
    "trace-free neo-Hookean": dict(mu=1.3),
    "Arruda-Boyce unconstrained": dict(ksi=1.0, N=6.0, kappa=3.0),
    "compressible Gent": dict(G=1.0, K=4.0, Jm=9.0),
    "Mooney-Rivlin": dict(c1=1.0, c2=0.3, k=50.0),
    "Veronda-Westmann": dict(c1=1.0, c2=0.8, k=50.0),
    "Ogden": dict(c1=1.0, m1=2.3, c2=0.4, m2=-1.7, k=20.0),
    "Arruda-Boyce": dict(mu=1.0, N=4.0, k=20.0),
    "Yeoh": dict(c1=1.0, c2=0.4, c3=0.2, k=20.0),
    "Gent": dict(G=1.0, Jm=9.0, k=20.0),
    "incomp neo-Hookean": dict(G=1.0, k=20.0),
    "uncoupled Holmes-Mow": dict(mu=1.0, beta=0.7, k=20.0),
    "trans iso Mooney-Rivlin": dict(c1=1.0, c2=0.3, k=50.0, **_EXP, lam_max=1.05, fiber=direction),
    "trans iso Veronda-Westmann": dict(c1=1.0, c2=0.3, k=50.0, **_EXP, lam_max=1.05, fiber=direction),
    "coupled trans-iso Mooney-Rivlin": dict(c1=1.0, c2=0.3, k=5.0, **_EXP, lam_max=1.05, fiber=direction),
    "coupled trans-iso Veronda-Westmann": dict(c1=1.0, c2=0.3, k=5.0, **_EXP, lambda_=1.05, fiber=direction),
    "2D trans iso Mooney-Rivlin": dict(c1=1.0, c2=0.3, k=5.0, **_EXP, lam_max=1.05, w=(1, 2), fiber=direction),
    "Mooney-Rivlin von Mises Fibers": dict(c1=1.0, c2=0.3, k=5.0, **_EXP, lam_max=1.05, kf=2.0, tp=0.4, vmc=2),
    "TC nonlinear orthotropic": dict(c1=1.0, c2=0.3, k=5.0, beta=(3, 4, 3.5), ksi=(1.0, 2.0, 3.0)),
    "orthotropic elastic": _ENG,
    "Fung orthotropic": dict(**_ENG, c=1.5, k=10.0),
    "Fung-ortho-compressible": dict(**_ENG, c=1.5, k=3.0),
    "orthotropic CLE": dict(**_CLE, mu1=0.5, mu2=0.6, mu3=0.7),
    "cubic CLE": dict(lp1=3.0, lm1=1.0, l2=0.4, mu=0.5),
    "Shenoy": dict(mu=1.0, k=3.0, Ef=2.0, lam_c=1.1, lam_t=0.2),
    "Holzapfel-Gasser-Ogden": dict(c=1.0, k1=2.0, k2=0.7, kappa=0.1, gamma=35.0, k=20.0),
    "HGO unconstrained": dict(c=1.0, k1=2.0, k2=0.7, kappa=0.1, gamma=35.0, k=20.0),
    "muscle material": dict(
        g1=0.5, g2=0.5, g3=0.1, p1=0.05, p2=6.6, Lofl=1.07, smax=3.0, lam_max=1.4, activation=0.7, k=20.0,
        fiber=direction,
    ),  # fmt: skip
    "tendon material": dict(g1=0.5, g2=0.5, l1=0.3, l2=4.0, lam_max=1.1, k=20.0, fiber=direction),
    "PRLig": dict(c1=1.0, c2=4.0, mu=1.0, v0=0.4, m=0.8, k=2.0),
    "Carter-Hayes": dict(E0=2.0, v=0.3, rho0=0.7, gamma=1.5),
    "fiber-exp-pow sbm": dict(alpha=0.5, beta=2.5, ksi0=2.0, rho0=0.7, gamma=1.5, fiber=direction),
    "fiber-pow-linear sbm": dict(E0=2.0, lam0=1.05, beta=2.5, rho0=0.7, gamma=1.5, fiber=direction),
    "fiber-exp-pow": dict(alpha=0.5, beta=2.5, ksi=2.0, mu=0.7, lam0=1.0, fiber=direction),
    "fiber-exponential-power-law": dict(alpha=0.5, beta=2.5, ksi=2.0, fiber=direction),
    "fiber-exp-pow-uncoupled": dict(alpha=0.5, beta=2.5, ksi=2.0, mu=0.7, k=10.0, fiber=direction),
    "fiber-pow-linear": dict(E=3.0, lam0=1.05, beta=3.0, fiber=direction),
    "fiber-pow-linear-uncoupled": dict(E=3.0, lam0=1.05, beta=3.0, fiber=direction, k=4.0),
    "fiber-exp-pow-linear": dict(E=3.0, lam0=1.05, beta=3.0, alpha=0.4, fiber=direction),
    "fiber-exp-linear": dict(c3=3.0, c4=4.0, c5=20.0, lambda_=1.05, fiber=direction),
    "uncoupled fiber-exp-linear": dict(c3=3.0, c4=4.0, c5=20.0, lambda_=1.05, fiber=direction, k=4.0),
    "fiber-NH": dict(mu=2.0, fiber=direction),
    "fiber-NH-uncoupled": dict(mu=2.0, fiber=direction, k=4.0),
    "fiber-pow": dict(ksi=2.0, beta=3.0, fiber=direction),
    "fiber-natural-NH": dict(ksi=2.0, lam0=1.02, fiber=direction),
    "fiber-entropy-chain": dict(ksi=2.0, N=4.0, mu=0.3, fiber=direction),
    "uncoupled fiber-entropy-chain": dict(ksi=2.0, N=4.0, fiber=direction, k=4.0),
    "fiber-Kiousis-uncoupled": dict(d1=2.0, d2=1.02, n=3.0, fiber=direction, k=4.0),
    "ellipsoidal fiber distribution": dict(beta=(2.5, 3.0, 3.5), ksi=(1.0, 2.0, 3.0)),
    "ellipsoidal fiber distribution (old)": dict(beta=(2.5, 3.0, 3.5), ksi=(1.0, 2.0, 3.0)),
    "EFD neo-Hookean": dict(E=1.0, v=0.3, beta=(2.5, 3.0, 3.5), ksi=(1.0, 2.0, 3.0)),
    "EFD neo-Hookean (new)": dict(E=1.0, v=0.3, beta=(2.5, 3.0, 3.5), ksi=(1.0, 2.0, 3.0)),
    "EFD uncoupled": dict(k=5.0, beta=(2.5, 3.0, 3.5), ksi=(1.0, 2.0, 3.0)),
    "EFD Mooney-Rivlin": dict(c1=1.0, c2=0.1, k=5.0, beta=(2.5, 3.0, 3.5), ksi=(1.0, 2.0, 3.0)),
    "EFD Veronda-Westmann": dict(c1=1.0, c2=0.5, k=5.0, beta=(2.5, 3.0, 3.5), ksi=(1.0, 2.0, 3.0)),
    "EFD Donnan equilibrium": dict(
        phiw0=0.8, cF0=0.2, bosm=0.3, R=8.3, T=0.3, beta=(2.5, 3.0, 3.5), ksi=(1.0, 2.0, 3.0)
    ),
    "perfect osmometer": dict(phiw0=0.8, iosm=0.3, bosm=0.2, R=8.3, T=0.3),
    "cell growth": dict(phir=0.3, cr=0.2, ce=0.3, R=8.3, T=0.3),
    "Donnan equilibrium": dict(phiw0=0.8, cF0=0.2, bosm=0.3, R=8.3, T=0.3),
    "prescribed uniaxial active contraction": dict(T0=1.5),
    "prescribed trans iso active contraction": dict(T0=1.5),
    "prescribed isotropic active contraction": dict(T0=1.5),
    "prescribed fiber active contraction": dict(T0=1.5, fiber=direction),
    "uncoupled prescribed uniaxial active contraction": dict(T0=1.5, k=4.0),
    "uncoupled prescribed trans iso active contraction": dict(T0=1.5, k=4.0),
    "uncoupled prescribed isotropic active contraction": dict(T0=1.5, k=4.0),
    "uncoupled prescribed fiber active contraction": dict(T0=1.5, k=4.0, fiber=direction),
    "Newtonian viscous solid": dict(kappa=1.0, mu=0.5),
    "Newtonian viscous solid uncoupled": dict(kappa=1.0, mu=0.5, k=3.0),
}


def _cdf():
    return of("cdf", "CDF Weibull", alpha=2.0, mu=0.5)


def _plastic(name, **kw):
    return solid(
        name,
        elastic=neo_hookean(),
        yield_criterion=of("criterion", "DC von Mises stress"),
        flow_curve=of("flow_curve", "PFC paper", Y0=0.05, Ymax=0.15, w0=0.4, we=0.1, nf=5, r=0.9),
        **kw,
    )


def _distribution(name, fiber, **kw):
    return solid(
        name,
        fibers=of("fiber", fiber, alpha=0.5, beta=3.0, ksi=2.0),
        distribution=of("distribution", "von-Mises-3d", b=2.0),
        scheme=of("scheme", "fibers-3d-geodesic", resolution=0),
        **kw,
    )


def _reactive(name, part, **kw):
    return solid(
        name, elastic=part(), bond=part(), relaxation=of("relaxation", "relaxation-exponential", tau=0.5), **kw
    )


def _damaged(name="elastic damage", part=neo_hookean, **kw):
    return solid(name, elastic=part(), damage=_cdf(), criterion=of("criterion", "DC Simo"), **kw)


def _fatigue(name="reactive fatigue", part=neo_hookean, **kw):
    return solid(
        name, elastic=part(), k0=0.4, beta=0.3, elastic_damage=_cdf(), elastic_criterion=of("criterion", "DC Simo"),
        fatigue_damage=of("cdf", "CDF Weibull", alpha=1.5, mu=0.3), fatigue_criterion=of("criterion", "DC Simo"), **kw,
    )  # fmt: skip


def _volume():
    """Eight elements, each other one stiff, whose inner node is off the middle."""
    X, conn = scenes.grid((2, 2, 2))
    middle = np.flatnonzero((abs(X - 0.5) < 0.1).all(axis=1))
    X[middle] += (0.1, -0.05, 0.08)
    parts = [(conn[::2], neo_hookean()), (conn[1::2], solid("neo-Hookean", E=9.0, v=0.2))]
    blocks = [Block(f"part {k}", "hex8", q, np.arange(len(q)), m) for k, (q, m) in enumerate(parts)]
    boundary = np.setdiff1d(np.arange(len(X)), middle)
    return Rve(Problem(X, blocks, [Step(newton=scenes.tight(dtol=1e-12))]), boundary)


def _w(v):
    return 0.4 * (v["I1"] - 3) + 0.1 * (v["I2"] - 3) + 0.3 * (v["I1"] - 3) ** 2 - 1.2 * np.log(v["J"]) + 2 * (
        v["J"] - 1
    ) ** 2


def _w_uncoupled(v):
    return 0.4 * (v["I1"] - 3) + 0.1 * (v["I2"] - 3) + 0.3 * (v["I1"] - 3) * (v["I2"] - 3)


def _w_fiber(x):
    bulk = 3.0 * (x["J"] - 1.0) ** 2 - 1.2 * np.log(x["J"])
    return 0.6 * (x["I1"] - 3.0) + 0.2 * (x["I4"] - 1.0) ** 2 * (x["I5"] - 1.0) ** 2 + bulk


COMPOSITE = {
    "solid mixture": lambda: solid(
        "solid mixture", solid=(neo_hookean(), solid("fiber-exp-pow", beta=2.5, ksi=2.0, fiber=direction))
    ),
    "uncoupled solid mixture": lambda: solid(
        "uncoupled solid mixture",
        k=20.0,
        solid=(mooney_rivlin(), solid("fiber-exp-pow-uncoupled", beta=2.5, ksi=2.0, fiber=direction)),
    ),
    "scaled elastic": lambda: solid("scaled elastic", solid=neo_hookean(), scale=0.4),
    "scaled uncoupled": lambda: solid("scaled uncoupled", solid=mooney_rivlin(), scale=0.4, k=3.0),
    "continuous fiber distribution": lambda: _distribution("continuous fiber distribution", "fiber-exp-pow"),
    "continuous fiber distribution uncoupled": lambda: _distribution(
        "continuous fiber distribution uncoupled", "fiber-exp-pow-uncoupled", k=5.0
    ),
    "viscoelastic": lambda: solid("viscoelastic", elastic=neo_hookean(), g1=0.5, t1=0.4, g2=0.3, t2=2.0),
    "uncoupled viscoelastic": lambda: solid(
        "uncoupled viscoelastic", elastic=mooney_rivlin(), k=10.0, g1=0.5, t1=0.4
    ),
    "viscoelastic damage": lambda: solid("viscoelastic damage", elastic=_damaged(), g1=0.5, t1=0.4),
    "uncoupled viscoelastic damage": lambda: solid(
        "uncoupled viscoelastic damage",
        elastic=_damaged("uncoupled elastic damage", mooney_rivlin),
        g1=0.5,
        t1=0.4,
        k=5.0,
    ),
    "reactive viscoelastic": lambda: _reactive("reactive viscoelastic", neo_hookean),
    "uncoupled reactive viscoelastic": lambda: _reactive("uncoupled reactive viscoelastic", mooney_rivlin, k=9.0),
    "reactive viscoelastic damage": lambda: solid(
        "reactive viscoelastic damage",
        viscoelastic=_reactive("reactive viscoelastic", neo_hookean),
        damage=_cdf(),
        criterion=of("criterion", "DC Simo"),
    ),
    "elastic damage": _damaged,
    "uncoupled elastic damage": lambda: _damaged("uncoupled elastic damage", mooney_rivlin, k=5.0),
    "reactive fatigue": _fatigue,
    "uncoupled reactive fatigue": lambda: _fatigue("uncoupled reactive fatigue", mooney_rivlin, k=5.0),
    "reactive viscoelastic fatigue": lambda: solid(
        "reactive viscoelastic fatigue",
        viscoelastic=solid(
            "reactive viscoelastic", elastic=_fatigue(), bond=neo_hookean(),
            relaxation=of("relaxation", "relaxation-exponential", tau=0.5),
        ),
    ),
    "reactive plasticity": lambda: _plastic("reactive plasticity"),
    "reactive plastic damage": lambda: _plastic(
        "reactive plastic damage",
        plastic_damage=_cdf(),
        plastic_damage_criterion=of("criterion", "DC octahedral shear strain"),
    ),
    "remodeling solid": lambda: solid(
        "remodeling solid", min_density=0.2, max_density=3.0, supply=of("solid_supply", "Huiskes-supply", B=0.8, k=0.1),
        solid=of("remodeled", "Carter-Hayes (old)", c=2.0, gamma=1.6, v=0.3, density_=1.1),
    ),
    "micro-material": lambda: solid("micro-material", RVE=_volume()),
    "kinematic growth": lambda: solid(
        "kinematic growth",
        elastic=neo_hookean(),
        growth=of("growth", "fiber growth", multiplier=1.3, fiber=direction),
    ),
    "prestrain elastic": lambda: solid(
        "prestrain elastic",
        elastic=solid("fiber-exp-linear", c3=1.0, c4=4.0, c5=2.0, lambda_=1.5, fiber=direction),
        prestrain=of("prestrain", "in-situ stretch", stretch=1.1),
    ),
    "uncoupled prestrain elastic": lambda: solid(
        "uncoupled prestrain elastic",
        elastic=mooney_rivlin(),
        k=4.0,
        prestrain=of("prestrain", "prestrain gradient", F0=np.diag([1.1, 0.95, 1.0])),
    ),
    "generation": lambda: solid_generation(0.0),
    "multigeneration": lambda: solid(
        "multigeneration", generation=(solid_generation(0.0), solid_generation(0.5))
    ),
    "fiber-CDF": lambda: solid("fiber-CDF", E=2.0, cdf_=_cdf(), fiber=direction),
    "fiber-CDF-uncoupled": lambda: solid("fiber-CDF-uncoupled", E=2.0, cdf_=_cdf(), fiber=direction, k=3.0),
    "hyperelastic": lambda: solid("hyperelastic", W=_w),
    "trans-iso hyperelastic": lambda: solid("trans-iso hyperelastic", W=_w_fiber, fiber=direction),
    "uncoupled trans-iso hyperelastic": lambda: solid(
        "uncoupled trans-iso hyperelastic", W=lambda x: _w_fiber({**x, "J": 1.0}), k=5.0, fiber=direction
    ),
    "uncoupled hyperelastic": lambda: solid("uncoupled hyperelastic", W=_w_uncoupled, k=5.0),
}


_TIMES = dict(tau=0.5, tau0=0.4, tau1=0.2, tau2=0.9, t1=0.4, t2=0.8, g1=0.4, g2=0.3, lambda_=0.6, n=0.7, beta=1.4,
              beta0=1.2, beta1=0.3, alpha=0.6, t1c0=0.2, t1c1=0.1, t1s0=0.8, t2c0=0.9, t2c1=0.2, t2s0=0.7)
_WITH = {
    "circular": {}, "spherical": {}, "ellipsoidal": dict(spa=(1.0, 2.0, 3.0)), "elliptical": dict(spa1=1.0, spa2=2.0),
    "structure-tensor": dict(spd=(1.0, 2.0, 1.5, 0.1, 0.2, 0.05)), "von-Mises-2d": dict(b=2.0),
    "von-Mises-3d": dict(b=2.0), "von-Mises-3d-two-axisym": dict(b=2.0, cosg=0.8),
    "CDF Simo": dict(a=0.3, b=0.2), "CDF Weibull": dict(alpha=2.0, mu=0.5), "CDF gamma": dict(alpha=2.0, mu=0.4),
    "CDF log-normal": dict(mu=0.5, sigma=0.8), "CDF quintic": dict(mumin=0.01, mumax=2.0), "CDF step": dict(mu=0.05),
    "CDF user": dict(cdf_=lambda x: 1.0 - np.exp(-x)),
    "DC Deshpande-Fleck": dict(beta=0.4), "DC Drucker shear stress": dict(c=0.3), "DC Drucker-Prager": dict(b=0.2),
    "PFC math": dict(nf=4, e0=0.02, emax=0.3, plastic_response=lambda e: 0.1 * e**0.3),
    "PFC paper": dict(Y0=0.05, Ymax=0.15, w0=0.4, we=0.1, nf=5, r=0.9), "PFC user": dict(plastic_response=Response()),
    "recruitment power": dict(alpha=1.5, mu0=1.1, mu1=2.0, scale=0.5), "recruitment polynomial": dict(mu1=0.7, mu2=3.0),
    "recruitment exponential": dict(alpha=1.2, mu0=1.1, mu1=0.8, scale=0.4), "recruitment user": dict(function=curve),
    "recruitment log-normal": dict(mu=0.1, sigma=0.6, max=2.0), "recruitment gamma": dict(mu=0.05, max=1.5),
    "recruitment Weibull": dict(alpha=1.5, mu=0.2, ploc=0.01, max=2.0),
    "recruitment quintic": dict(mumin=0.02, mumax=0.9, max=1.5),
    "general growth": dict(iso=1.2, ani=1.1, fiber=direction),
    "in-situ stretch": dict(stretch=1.1), "prestrain gradient": dict(F0=np.diag([1.1, 0.95, 1.0]).ravel()),
}  # fmt: skip


def _part(table, name):
    """A record of a table below the solids', with numbers that matter."""
    cls = load(table, name)
    if table == "relaxation":
        user = "user" in name
        curves = dict(tau=curve, tau1=curve, tau2=lambda x: 1.5 + x, beta=lambda x: 1.2 + x)
        given = curves if user else _TIMES
        return cls(**{f.name: given[f.name] for f in fields(cls) if f.init and f.name in given})
    if table == "growth" and name not in _WITH:
        return cls(multiplier=1.3, fiber=direction)
    if table == "active":
        return cls(ascl=1.0, Tmax=0.4, ca0=4.3, camax=4.3, beta=4.7, l0=1.5, refl=2.0)
    return cls(**_WITH.get(name, {}))


def nested():
    """Solids with each record of the tables below them, by "table: name"."""
    out = {}
    for table, make in {
        "relaxation": lambda p: solid("reactive viscoelastic", elastic=neo_hookean(), bond=neo_hookean(), relaxation=p),
        "recruitment": lambda p: solid(
            "reactive viscoelastic", elastic=neo_hookean(), bond=neo_hookean(), recruitment=p,
            relaxation=of("relaxation", "relaxation-exponential", tau=0.5),
        ),
        "cdf": lambda p: solid("elastic damage", elastic=neo_hookean(), damage=p, criterion=of("criterion", "DC Simo")),
        "criterion": lambda p: solid("elastic damage", elastic=neo_hookean(), damage=_cdf(), criterion=p),
        "flow_curve": lambda p: solid(
            "reactive plasticity", elastic=neo_hookean(), yield_criterion=of("criterion", "DC von Mises stress"),
            flow_curve=p,
        ),
        "growth": lambda p: solid("kinematic growth", elastic=neo_hookean(), growth=p),
        "prestrain": lambda p: solid(
            "prestrain elastic", prestrain=p,
            elastic=solid("fiber-exp-linear", c3=1.0, c4=4.0, c5=2.0, lambda_=1.5, fiber=direction),
        ),
        "distribution": lambda p: solid(
            "continuous fiber distribution", fibers=of("fiber", "fiber-exp-pow", alpha=0.5, beta=3.0, ksi=2.0),
            distribution=p, scheme=of("scheme", "fibers-3d-geodesic", resolution=0),
        ),
        "active": lambda p: solid(
            "trans iso Mooney-Rivlin", c1=1.0, c2=0.3, k=5.0, **_EXP, lam_max=1.05, fiber=direction,
            active_contraction=p,
        ),
    }.items():  # fmt: skip
        for name in tables()[table]:
            out[f"{table}: {name}"] = (lambda m, t, n: lambda: m(_part(t, n)))(make, table, name)
    return out


def solid_generation(start):
    return of("generation", "generation", start_time=start, solid=neo_hookean())


def example(name):
    """An example of the solid ``name``."""
    return COMPOSITE[name]() if name in COMPOSITE else solid(name, **SIMPLE[name])


#: energies that do not belong to the stress, in FEBio either, or are of dissipative laws
NO_ENERGY_LAW = {
    **dict.fromkeys(("damage fiber power", "damage fiber exponential", "damage fiber exp-linear"), "damage grows"),
    "damage trans iso Mooney-Rivlin": "damage",
    "von-Mises plasticity": "it has no energy",
    **dict.fromkeys(_TIRED, "damage grows"),
    "Carreau-Yasuda viscous solid": "viscous",
    "damage neo-Hookean": "damage",
    "damage Mooney-Rivlin": "damage",
    "active fiber stress": "it has no energy",
    "uncoupled active fiber stress": "it has no energy",
    "uncoupled active contraction": "it has no energy",
    "osmotic virial expansion": "osmotic",
    "2D fiber neo-Hookean": "its active tension has no energy",
    "fiber neo-Hookean": "its active tension has no energy",
    "Yeoh": "its stress takes sum c_i (I1 - 3)^(i - 1) for the derivative of its energy",
    "Shenoy": "it has no energy",
    "remodeling solid": "its mass follows the energy",
    "muscle material": "it has no energy",
    "tendon material": "it has no energy",
    "EFD Donnan equilibrium": "osmotic",
    "perfect osmometer": "osmotic",
    "cell growth": "osmotic",
    "Donnan equilibrium": "osmotic",
    "Newtonian viscous solid": "viscous",
    "Newtonian viscous solid uncoupled": "viscous",
    "viscoelastic": "viscous",
    "uncoupled viscoelastic": "viscous",
    "viscoelastic damage": "viscous",
    "uncoupled viscoelastic damage": "viscous",
    "reactive viscoelastic": "viscous",
    "uncoupled reactive viscoelastic": "viscous",
    "reactive viscoelastic damage": "viscous",
    "elastic damage": "damage grows",
    "uncoupled elastic damage": "damage grows",
    "reactive plasticity": "plastic",
    "reactive plastic damage": "plastic",
    "kinematic growth": "the energy is per grown volume",
    "prestrain elastic": "the energy is per strained volume",
    "uncoupled prestrain elastic": "the energy is per strained volume",
    "fiber-CDF": "its stress is (In - 1) times the derivative of its energy",
    "fiber-CDF-uncoupled": "its stress is (In - 1) times the derivative of its energy",
}

#: tangents that are not the derivative of the stress
NO_TANGENT_LAW = {
    "damage neo-Hookean": _GROWTH,
    "damage Mooney-Rivlin": _GROWTH,
    "damage trans iso Mooney-Rivlin": _GROWTH,
    "von-Mises plasticity": "it is of small strains",
    **dict.fromkeys(_TIRED, _GROWTH),
    "Carreau-Yasuda viscous solid": _HISTORY,
    "active fiber stress": "FEBio's tangent takes the rate's slope for one of the stretch",
    "uncoupled active contraction": _ACTIVE,
    "2D fiber neo-Hookean": _ACTIVE,
    "fiber neo-Hookean": _ACTIVE,
    "Newtonian viscous solid": _HISTORY,
    "Newtonian viscous solid uncoupled": _HISTORY,
    "viscoelastic damage": _GROWTH,
    "uncoupled viscoelastic damage": _GROWTH,
    "reactive viscoelastic damage": _GROWTH,
    "elastic damage": _GROWTH,
    "uncoupled elastic damage": _GROWTH,
    "reactive plasticity": _SECANT,
    "reactive plastic damage": _SECANT,
    "fiber-CDF": _HISTORY,
    "fiber-CDF-uncoupled": _HISTORY,
}

#: laws that are not objective, FEBio's neither
NOT_OBJECTIVE = {
    "Newtonian viscous solid": "its rate of deformation is by differences in time",
    "Newtonian viscous solid uncoupled": "its rate of deformation is by differences in time",
    "Carreau-Yasuda viscous solid": "its rate of deformation is by differences in time",
    "von-Mises plasticity": "it is of small strains",
}

#: stressed in the reference configuration
STRESSED_AT_REST = {
    "spherical fiber distribution",  # its directions are given to eight digits
    "spherical fiber distribution sbm",
    "active fiber stress",
    "uncoupled active fiber stress",
    "osmotic virial expansion",
    "2D fiber neo-Hookean",
    "fiber neo-Hookean",
    "compressible Gent",
    "coupled Veronda-Westmann",
    "coupled trans-iso Veronda-Westmann",
    "EFD Donnan equilibrium",
    "perfect osmometer",
    "cell growth",
    "Donnan equilibrium",
    "kinematic growth",
    "prestrain elastic",
    "uncoupled prestrain elastic",
    "muscle material",
    "hyperelastic",
    *(k for k in SIMPLE if "contraction" in k),
}

"""Which of FEBio 4.11's types belong to its modules of solids and mixtures, and what those within a material are.

Facts of its class registrations, as :mod:`.features`, whose names and parameters these sort.
"""

from __future__ import annotations

from functools import cache

from .features import table

# of the types that stand within materials, loads and steps ("other" of the table): kind and its types
WITHIN = r"""
active contraction: active_contraction; force-velocity-Estrada; uncoupled active_contraction
active momentum supply: active-const-supply
adaptor criterion: contact gap; damage; element data; element_selection; math; max_variable; min-max
  filter; relative error; relative volume; spring force; spring stretch; stress
axes: angles; const; cylindrical; local; map; polar; spherical; vector
bond recruitment: recruitment Weibull; recruitment exponential; recruitment gamma; recruitment log-normal;
  recruitment polynomial; recruitment power; recruitment quintic; recruitment user
bond relaxation: relaxation-CSexp; relaxation-CSexp-dist-user; relaxation-Carreau; relaxation-Fung;
  relaxation-Malkin; relaxation-Malkin-dist-user; relaxation-Malkin-distortion; relaxation-Park;
  relaxation-Park-dist-user; relaxation-Park-distortion; relaxation-Prony; relaxation-exp-dist-user;
  relaxation-exp-distortion; relaxation-exponential; relaxation-power; relaxation-power-dist-user;
  relaxation-power-distortion
damage criterion: DC Deshpande-Fleck; DC Drucker shear stress; DC Drucker-Prager; DC Simo; DC max normal
  Lagrange strain; DC max normal stress; DC max shear stress; DC octahedral natural strain; DC octahedral
  shear strain; DC specific strain energy; DC strain energy density; DC von Mises stress
damage distribution: CDF Simo; CDF Weibull; CDF gamma; CDF log-normal; CDF quintic; CDF step; CDF user
data record: element_data; face_data; node_data; rigid_body_data; rigid_connector_data
diffusivity: diff-Albro-iso; diff-const-iso; diff-const-ortho; diff-ref-iso
direction: angles; cylindrical; local; map; math; spherical; user; vector
fiber distribution: circular; ellipsoidal; elliptical; spherical; structure-tensor; von-Mises-2d;
  von-Mises-3d; von-Mises-3d-two-axisym
fiber material: fiber-CDF; fiber-CDF-uncoupled; fiber-NH; fiber-NH-uncoupled; fiber-entropy-chain;
  fiber-exp-linear; fiber-exp-pow; fiber-exp-pow-linear; fiber-exp-pow-uncoupled; fiber-natural-NH;
  fiber-pow; fiber-pow-linear; fiber-pow-linear-uncoupled; uncoupled fiber-entropy-chain; uncoupled
  fiber-exp-linear
function: const; linear ramp; math; point; scale; step
growth tensor: area growth; fiber growth; general growth; volume growth
integration scheme: fibers-2d-trapezoidal; fibers-3d-fei; fibers-3d-gauss; fibers-3d-geodesic;
  fibers-3d-gkt
linear solver: LU; accelerate; bicgstab; bipn; block; boomeramg; cg; diagonal; feast; fgmres; hypre_gmres;
  hypre_pcg_amg; ichol; ilu0; ilut; mkl_dss; pardiso; pardiso-project; pardiso_64; schur; skyline;
  strategy; superlu_mt; test
membrane reaction: membrane-mass-action-forward; membrane-mass-action-reversible
membrane reaction rate: membrane constant reaction rate; membrane ion channel reaction rate; membrane
  voltage-gated reaction rate
optimisation method: constrained levmar; levmar; powell; scan
osmotic coefficient: osm-coef-Manning; osm-coef-const
permeability: perm-Holmes-Mow; perm-const-iso; perm-exp-iso; perm-ref-iso; perm-ref-ortho;
  perm-ref-trans-iso
plastic flow curve: PFC math; PFC paper; PFC user
prestrain gradient: in-situ stretch; prestrain gradient
quasi-Newton method: BFGS; Broyden; JFNK; full Newton; modified Newton
reaction: Michaelis-Menten; concentration-independent; mass-action-forward; mass-action-forward-effective;
  mass-action-reversible; mass-action-reversible-effective
reaction rate: Huiskes reaction rate; Nims reaction rate; Ruberti reaction rate; constant reaction rate;
  exp-sed reaction rate; solute-as-sbm reaction rate
solid supply: Huiskes-supply
solubility: solub-Manning; solub-const
solute supply: supply-Michaelis-Menten; supply-binding; supply-const; supply-synthesis-binding
solvent supply: Starling
value: const; image map; map; math
"""
# registered for fluids alone: fluid, FSI, thermo-fluid, polar fluid
FLUIDS = r"""
material: biphasic-FSI; fluid; fluid-FSI; fluid-solutes; multiphasic-FSI; polar fluid; solutes;
  thermo-fluid
bc: fluid RC; fluid RCR; fluid pressure; fluid resistance; fluid rotational velocity; natural temperature; prescribed
  fluid angular velocity; prescribed fluid dilatation; prescribed fluid temperature; prescribed fluid
  velocity; zero fluid angular velocity; zero fluid dilatation; zero fluid temperature; zero fluid
  velocity
surface_load: biphasic-FSI traction; fluid RC; fluid RCR; fluid backflow stabilization; fluid heat flux;
  fluid mixture viscous traction; fluid natural heat flux; fluid normal traction; fluid normal velocity;
  fluid resistance; fluid tangential damping; fluid tangential stabilization; fluid velocity; fluid
  viscous traction; fluid-FSI traction; multiphasic-FSI traction; solute backflow stabilization; solute
  convective flow; solute flux; temperature backflow stabilization
body_load: constant fluid heat supply; fluid body force; fluid centrifugal force; fluid moving frame;
  polar fluid body moment
ic: initial fluid angular velocity; initial fluid dilatation; initial fluid pressure and temperature;
  initial fluid temperature; initial fluid velocity
contact: tied-fluid
constraint: fluid pressure constraint; frictionless fluid wall; normal fluid flow; uniform fluid flow
mesh_adaptor: fsi-volume-erosion
analysis: fluid; fluid-FSI; fluid-solutes; multiphasic-FSI; polar fluid; thermo-fluid
solver: fluid; fluid-FSI; fluid-solutes; multiphasic-FSI; polar fluid; solutes; thermo-fluid
domain: biphasic-FSI-3D; fluid-FSI-3D; fluid-solutes-3D; multiphasic-FSI-3D
plot: dilatation gradient; elastic fluid pressure; fluid acceleration; fluid body force; fluid bulk
  modulus; fluid density; fluid density rate; fluid dilatation; fluid element angular momentum; fluid
  element center of mass; fluid element kinetic energy; fluid element linear momentum; fluid element
  strain energy; fluid energy density; fluid heat flux; fluid heat supply density; fluid isobaric specific
  heat capacity; fluid isochoric specific heat capacity; fluid kinetic energy density; fluid mass flow
  rate; fluid pressure tangent strain; fluid pressure tangent temperature; fluid rate of deformation;
  fluid relative Reynolds number; fluid relative thermal Peclet number; fluid shear stress error; fluid
  shear viscosity; fluid specific entropy; fluid specific free energy; fluid specific free enthalpy; fluid
  specific gauge enthalpy; fluid specific internal energy; fluid specific strain energy; fluid strain
  energy density; fluid stress; fluid stress power density; fluid surface energy flux; fluid surface
  force; fluid surface moment; fluid surface pressure; fluid surface traction power; fluid temperature;
  fluid thermal conductivity; fluid velocity; fluid volume ratio; fluid volume ratio gradient; fluid
  vorticity; nodal fluid temperature; nodal fluid velocity; nodal polar fluid angular velocity; polar
  fluid angular velocity; polar fluid couple stress; polar fluid regional angular velocity; polar fluid
  relative angular velocity; polar fluid stress; relative fluid velocity; solid volume fraction; solute
  relative Peclet number
log: fJ; fax; fay; faz; fd; fdxx; fdxy; fdxz; fdyy; fdyz; fdzz; fmxs; fp; fs1; fs2; fs3; fsp; fsxx; fsxy;
  fsxz; fsyy; fsyz; fszz; fvx; fvy; fvz; fwx; fwy; fwz; fx; fy; fz; nfvx; nfvy; nfvz
"""
# the module of what solids alone do not have
MODULES = r"""
biphasic: biphasic; fluidflux; initial fluid pressure; initial shell fluid pressure; nodal
  fluidflux; prescribed fluid pressure; prescribed shell fluid pressure; pressure_stabilization;
  sliding-biphasic; sliding-biphasic-mixed; sliding2; tied-biphasic; zero fluid pressure
multiphasic: actual fluid pressure; biphasic-solute; fluid pressure; initial concentration; initial shell concentration;
  matching_osm_coef; multiphasic; multiphasic-multigeneration; prescribed concentration; sbm point source;
  sliding-biphasic-solute; sliding-multiphasic; solute; solute natural flux; solute point
  source; soluteflux; spherical fiber distribution sbm; tied-multiphasic; triphasic; zero concentration
"""
# kinds as they are listed: of the table, and what they are called
KINDS = {
    "material": "material", "discrete_material": "discrete material", "domain": "domain", "bc": "boundary condition",
    "ic": "initial condition", "load": "load", "contact": "contact", "constraint": "constraint",
    "load_controller": "load controller", "map": "data generator", "mesh_adaptor": "mesh adaptor", "solver": "solver",
    "plot": "plot variable", "log": "log item",
}  # fmt: skip


def _lists(text: str) -> dict[str, list[str]]:
    lines = (line.split(": ", 1) for line in text.strip().replace("\n  ", " ").split("\n"))
    return {kind: names.split("; ") for kind, names in lines}


@cache
def registered() -> dict[str, tuple[str, ...]]:
    """The types of solids and mixtures by kind, and the tags of <Control>."""
    fluids = _lists(FLUIDS)
    fluids["load"] = [t for k in ("nodal_load", "surface_load", "body_load") for t in fluids.get(k, [])]
    out = {
        name: tuple(t for t in table()[kind] if t not in fluids.get(kind, ())) for kind, name in KINDS.items()
    }
    out["material"] = tuple(t for t in out["material"] if t not in table()["discrete_material"])
    for kind, parents in (("control tag", "analysis"), ("solver tag", "solver")):
        tags = (known for parent, known in table()[parents].items() if parent not in fluids[parents])
        out[kind] = tuple(sorted(set().union(*tags)))
    return out | {kind: tuple(names) for kind, names in _lists(WITHIN).items()}


@cache
def module(name: str) -> str:
    """The module of a type: "solid" where solids have it."""
    return next((m for m, names in _lists(MODULES).items() if name in names), "solid")

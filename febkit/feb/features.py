"""What FEBio 4.11 knows: types and their parameters, from its class registrations (facts, not code)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache

# one block per kind ("# bc"); a line per type: parameters of that type and of its base classes
TABLE = r"""
# material
2D fiber neo-Hookean: E a active_contraction density mat_axis v
2D trans iso Mooney-Rivlin: a active_contraction c1 c2 c3 c4 c5 density fiber k lam_max pressure_model w
2D trans iso Veronda-Westmann: c1 c2 c3 c4 c5 density k lam_max mat_axis pressure_model w
Arruda-Boyce: N density k mu pressure_model
Arruda-Boyce unconstrained: N density kappa ksi n_term
Carreau-Yasuda viscous solid: a density lambda mu0 mui n
Carter-Hayes: E0 density gamma rho0 sbm v
Carter-Hayes (old): c density gamma v
Donnan equilibrium: Phi bosm cF0 density phis0 phiw0
EFD Donnan equilibrium: Phi beta bosm cF0 density ksi mat_axis phiw0
EFD Mooney-Rivlin: beta c1 c2 density k ksi pressure_model
EFD Veronda-Westmann: beta c1 c2 density k ksi pressure_model
EFD neo-Hookean: E beta density ksi v
EFD neo-Hookean (new): E beta density ksi v
EFD uncoupled: beta density k ksi mat_axis pressure_model
Fung orthotropic: E1 E2 E3 G12 G23 G31 c density k mat_axis pressure_model v12 v23 v31
Fung-ortho-compressible: E1 E2 E3 G12 G23 G31 c density k mat_axis v12 v23 v31
Gent: G Jm density k pressure_model
HGO unconstrained: c density gamma k k1 k2 kappa mat_axis
HGO-coronary: density fiber k k1 k2 pressure_model rho
Hill: Fmax Ftl Fvl Ksh L0 Lmax Sv Vmax ac
Holmes-Mow: E beta density v
Holzapfel-Gasser-Ogden: c density gamma k k1 k2 kappa mat_axis pressure_model
Mooney-Rivlin: c1 c2 density k pressure_model
Mooney-Rivlin AD: c1 c2 density k pressure_model
Mooney-Rivlin von Mises Fibers: c1 c2 c3 c4 c5 density gipt k kf lam_max mat_axis pressure_model tp var_n
  vmc
Newtonian viscous solid: density kappa mu secant_tangent
Newtonian viscous solid uncoupled: density k kappa mu pressure_model secant_tangent
Ogden: c1 c2 c3 c4 c5 c6 density k m1 m2 m3 m4 m5 m6 pressure_model
Ogden unconstrained: c1 c2 c3 c4 c5 c6 cp density m1 m2 m3 m4 m5 m6
PRLig: c1 c2 density k m mat_axis mu v0
Shenoy: Ef density k lam_c lam_t m mu n
St.Venant-Kirchhoff: E density v
TC nonlinear orthotropic: beta c1 c2 density k ksi mat_axis pressure_model
Veronda-Westmann: c1 c2 density k pressure_model
Yeoh: c1 c2 c3 c4 c5 c6 density k pressure_model
active fiber stress: activation density mat_axis smax stl stv
biphasic: active_supply fluid_density mat_axis permeability phi0 solid solvent_supply tau
biphasic-FSI: fluid permeability phi0 solid solvent_supply
biphasic-solute: fluid_density mat_axis osmotic_coefficient permeability phi0 solid solute
cell growth: ce cr density phir
compressible Gent: G Jm K density
continuous fiber distribution: density distribution fibers mat_axis scheme
continuous fiber distribution uncoupled: density distribution fibers k mat_axis pressure_model scheme
coupled Mooney-Rivlin: c1 c2 density k
coupled Veronda-Westmann: c1 c2 density k
coupled trans-iso Mooney-Rivlin: c1 c2 c3 c4 c5 density fiber k lam_max
coupled trans-iso Veronda-Westmann: c1 c2 c3 c4 c5 density fiber k lambda
cubic CLE: density l2 lm1 lp1 mat_axis mu
damage Mooney-Rivlin: beta c1 c2 density k pressure_model smax smin
damage fiber exp-linear: D2_a D2_b D2_c D2_d D3_g0 D3_inf D3_rg Dmax beta_s c3 c4 c5 density fiber
  gamma_max lambda t0
damage fiber exponential: D2_a D2_b D2_c D2_d D3_g0 D3_inf D3_rg Dmax beta_s density fiber gamma_max k1 k2
  kappa t0
damage fiber power: D2_a D2_b D2_c D2_d D3_g0 D3_inf D3_rg Dmax a1 a2 beta_s density fiber gamma_max kappa
  t0
damage neo-Hookean: E a b density v
damage trans iso Mooney-Rivlin: Fbeta Fsmax Fsmin Mbeta Msmax Msmin c1 c2 c3 c4 density k mat_axis
  pressure_model
discrete composite: mat
elastic damage: criterion damage density elastic
elastic membrane: E v
ellipsoidal fiber distribution: beta density ksi mat_axis
ellipsoidal fiber distribution (old): beta density ksi
experimental spring: E sM sm
fiber neo-Hookean: E a active_contraction density mat_axis v
fiber-CDF: E cdf density epsf fiber
fiber-CDF-uncoupled: E cdf density epsf fiber k pressure_model
fiber-Kiousis-uncoupled: d1 d2 density fiber k n pressure_model
fiber-NH: density fiber mu
fiber-NH-uncoupled: density fiber k mu pressure_model
fiber-entropy-chain: N density fiber ksi mu n_term
fiber-exp-linear: c3 c4 c5 density fiber lambda
fiber-exp-pow: alpha beta density fiber ksi lam0 mu
fiber-exp-pow sbm: alpha beta density fiber gamma ksi0 rho0 sbm
fiber-exp-pow-linear: E alpha beta density fiber lam0
fiber-exp-pow-uncoupled: alpha beta density fiber k ksi mu pressure_model
fiber-exponential-power-law: alpha beta density fiber ksi lam0 mu
fiber-exponential-power-law-uncoupled: alpha beta density fiber k ksi mu pressure_model
fiber-natural-NH: density fiber ksi lam0
fiber-pow: beta density fiber ksi tension_only
fiber-pow-linear: E beta density fiber lam0 tension_only
fiber-pow-linear sbm: E0 beta density fiber gamma lam0 rho0 sbm
fiber-pow-linear-uncoupled: E beta density fiber k lam0 pressure_model
fiberODF: density fiber_odf fibers mat_axis
fluid: density elastic k viscous
fluid-FSI: fluid solid
fluid-solutes: dms fluid osmotic_coefficient reaction solute
hyperelastic: W density
incomp neo-Hookean: G density k pressure_model
isotropic Hencky: E density v
isotropic Lee-Sacks: c0 c1 c2 density k tangent_scale
isotropic elastic: E density v
kinematic growth: density elastic growth
linear spring: E
linear truss: E density v
linear-beam: A A1 A2 E G I1 I2 density
lung: E c1 c3 d1 d3 density v
micro-material: RVE bc_set density probe rve_type scale
micro-material2O: KDG1 KDG2 KDG3 RVE bc_set beta density probe rve_type scale useJ0
mindlin elastic: KDG1 KDG2 KDG3 a1 a2 a3 a4 a5 beta density lam mu useJ0
multigeneration: density generation
multiphasic: fixed_charge_density fluid_density mat_axis membrane_reaction osmotic_coefficient penalty
  permeability phi0 reaction solid solid_bound solute solvent_supply
multiphasic-FSI: dms fixed_charge_density fluid osmotic_coefficient penalty permeability phi0 reaction
  solid solute solvent_supply
multiphasic-multigeneration: fixed_charge_density fluid_density gen_time mat_axis membrane_reaction
  osmotic_coefficient penalty permeability phi0 reaction solid solid_bound solute solvent_supply
muscle material: Lofl activation density fiber g1 g2 g3 k lam_max p1 p2 pressure_model smax
natural neo-Hookean: E density v
neo-Hookean: E density v
neo-Hookean AD: E density v
neo-Hookean transiso: Ep Ez density gz mat_axis vp vz
nonlinear spring: force measure scale
orthotropic CLE: density l12 l23 l31 lm11 lm22 lm33 lp11 lp22 lp33 mat_axis mu1 mu2 mu3
orthotropic elastic: E1 E2 E3 G12 G23 G31 density mat_axis v12 v23 v31
osmotic virial expansion: c1 c2 c3 cr density phiw0
perfect osmometer: bosm density iosm phiw0
polar fluid: density elastic k kg polar viscous
polynomial: D1 D2 c01 c02 c10 c11 c12 c20 c21 c22 density
porous neo-Hookean: E density phi0
prescribed fiber active contraction: T0 density fiber
prescribed isotropic active contraction: T0 density
prescribed trans iso active contraction: T0 density mat_axis
prescribed uniaxial active contraction: T0 density mat_axis
prestrain elastic: density elastic prestrain
reactive fatigue: beta density elastic elastic_criterion elastic_damage fatigue_criterion fatigue_damage k0
reactive plastic damage: density elastic elastic_damage elastic_damage_criterion flow_curve isochoric
  plastic_damage plastic_damage_criterion rtol secant_tangent yield_criterion
reactive plasticity: density elastic flow_curve isochoric rtol secant_tangent yield_criterion
reactive viscoelastic: bond density elastic emin kinetics recruitment relaxation trigger wmin
reactive viscoelastic damage: criterion damage density viscoelastic
reactive viscoelastic fatigue: density viscoelastic
remodeling solid: density max_density min_density solid supply
rigid body: E center_of_mass density override_com v
scaled elastic: density scale solid
scaled uncoupled: density k pressure_model scale solid
solid mixture: density mat_axis solid
solutes: osmotic_coefficient reaction solute
spherical fiber distribution: alpha beta density ksi mat_axis
spherical fiber distribution sbm: alpha beta density gamma ksi0 mat_axis rho0 sbm
tendon material: density fiber g1 g2 k l1 l2 lam_max pressure_model
tension-only linear spring: E
thermo-fluid: conduct density elastic viscous
torsion spring: r
trace-free neo-Hookean: density mu
trans iso MR-Estrada: active_contraction c1 c2 c3 c4 c5 density fiber k lam_max pressure_model
trans iso Mooney-Rivlin: active_contraction c1 c2 c3 c4 c5 density fiber k lam_max pressure_model
trans iso Veronda-Westmann: active_contraction c1 c2 c3 c4 c5 density fiber k lam_max pressure_model
trans-iso hyperelastic: W density fiber
triphasic: fixed_charge_density fluid_density mat_axis osmotic_coefficient penalty permeability phi0 solid
  solute
uncoupled Holmes-Mow: beta density k mu pressure_model
uncoupled active contraction: Tmax beta ca0 camax density k l0 mat_axis pressure_model refl
uncoupled active fiber stress: activation density k mat_axis pressure_model smax stl stv
uncoupled elastic damage: criterion damage density elastic k pressure_model
uncoupled fiber-entropy-chain: N density fiber k ksi n_term pressure_model
uncoupled fiber-exp-linear: c3 c4 c5 density fiber k lambda pressure_model
uncoupled hyperelastic: W density k pressure_model print_derivs
uncoupled isotropic Lee-Sacks: c0 c1 c2 density k pressure_model tangent_scale
uncoupled prescribed fiber active contraction: T0 density fiber k pressure_model
uncoupled prescribed isotropic active contraction: T0 density k pressure_model
uncoupled prescribed trans iso active contraction: T0 density k mat_axis pressure_model
uncoupled prescribed uniaxial active contraction: T0 density k mat_axis pressure_model
uncoupled prestrain elastic: density elastic k pressure_model prestrain
uncoupled reactive fatigue: beta density elastic elastic_criterion elastic_damage fatigue_criterion
  fatigue_damage k k0 pressure_model
uncoupled reactive viscoelastic: bond density elastic emin k kinetics pressure_model recruitment
  relaxation trigger wmin
uncoupled solid mixture: density k mat_axis pressure_model solid
uncoupled trans-iso hyperelastic: W density fiber k pressure_model print_derivs
uncoupled viscoelastic: density elastic g0 g1 g2 g3 g4 g5 g6 k pressure_model t1 t2 t3 t4 t5 t6
uncoupled viscoelastic damage: density elastic g0 g1 g2 g3 g4 g5 g6 k pressure_model t1 t2 t3 t4 t5 t6
viscoelastic: density elastic g0 g1 g2 g3 g4 g5 g6 t1 t2 t3 t4 t5 t6
viscoelastic damage: density elastic g0 g1 g2 g3 g4 g5 g6 t1 t2 t3 t4 t5 t6
von-Mises plasticity: E H Y density v
wrinkle Ogden: alpha mu prestretch wrinkle
# discrete_material
Hill: Fmax Ftl Fvl Ksh L0 Lmax Sv Vmax ac
discrete composite: mat
experimental spring: E sM sm
linear spring: E
nonlinear spring: force measure scale
tension-only linear spring: E
torsion spring: r
# bc
actual fluid pressure: pressure shell_bottom
fix: dofs
fluid RC: Bernoulli R capacitance initial_pressure
fluid RCR: R Rd capacitance initial_pressure pressure_offset
fluid pressure: pressure
fluid resistance: R pressure_offset
fluid rotational velocity: angular_speed axis origin relative
linear constraint: child_dof dof node offset
matching_osm_coef: ambient_osmolarity ambient_pressure shell_bottom
natural temperature:
normal displacement: relative scale surface_hint
prescribe: dof relative scale
prescribed concentration: dof relative value
prescribed deformation: F relative scale
prescribed deformation 2O: F G reference relative scale
prescribed displacement: dof relative value
prescribed fluid angular velocity: dof relative value
prescribed fluid dilatation: relative value
prescribed fluid pressure: relative value
prescribed fluid temperature: relative value
prescribed fluid velocity: dof relative value
prescribed rotation: dof relative value
prescribed shell displacement: dof relative value
prescribed shell fluid pressure: relative value
rigid: clamp_shells rb
rigid deformation: pos relative rot
rigid_displacement: dof rb relative value
rigid_euler_angles: Ex Ey Ez convention rb
rigid_fixed: Ru_dof Rv_dof Rw_dof Rx_dof Ry_dof Rz_dof rb
rigid_fixed_old: dofs rb
rigid_prescribed_old: dof rb relative value
rigid_rotation: dof rb relative value
rigid_rotation_vector: rb vx vy vz
zero concentration: c_dof
zero displacement: x_dof y_dof z_dof
zero fluid angular velocity: gx_dof gy_dof gz_dof
zero fluid dilatation:
zero fluid pressure:
zero fluid temperature:
zero fluid velocity: wx_dof wy_dof wz_dof
zero rotation: u_dof v_dof w_dof
zero shell displacement: sx_dof sy_dof sz_dof
# nodal_load
nodal fluidflux: relative value
nodal_force: relative shell_bottom value
nodal_load: dof relative scale
nodal_target_force: force scale shell_bottom
# surface_load
bearing load: force linear profile scale shell_bottom symmetric_stiffness
biphasic-FSI traction: shell_bottom
fluid RC: Bernoulli R capacitance initial_pressure
fluid RCR: R Rd capacitance initial_pressure pressure_offset
fluid backflow stabilization: beta
fluid heat flux: flux
fluid mixture viscous traction: scale traction
fluid natural heat flux:
fluid normal traction: traction
fluid normal velocity: parabolic prescribe_nodal_velocities prescribe_rim_pressure velocity
fluid pressure: pressure
fluid resistance: R pressure_offset
fluid tangential damping: penalty
fluid tangential stabilization: beta
fluid velocity: scale velocity
fluid viscous traction: scale traction
fluid-FSI traction: shell_bottom
fluidflux: flux linear mixture shell_bottom
force: force scale shell_bottom
ideal gas pressure: P0 shell_bottom symmetric_stiffness
matching_osm_coef: ambient_osmolarity ambient_pressure shell_bottom
multiphasic-FSI traction: shell_bottom
normal_traction: effective linear shell_bottom traction
pipette aspiration: center normal pressure radius
pressure: linear pressure shell_bottom symmetric_stiffness
pressure Robin BC: dashpot_eps shell_bottom spring_eps
pressure_stabilization: stabilize
solute backflow stabilization: sol solute_id
solute convective flow: solute_id
solute flux: flux sol solute_id
solute natural flux: shell_bottom solute_id update
soluteflux: flux linear shell_bottom solute_id
temperature backflow stabilization:
traction: linear scale shell_bottom traction
traction Robin BC: dashpot_eps shell_bottom spring_eps
# body_load
axial force: axis c p scale
body force: force
centrifugal: angular_speed rotation_axis rotation_center
const: x y z
constant fluid heat supply: r
fluid body force: force
fluid centrifugal force: angular_speed rotation_axis rotation_center
fluid moving frame: Wt ax ay az frame rt wt wx wy wz
mass damping: C
moving frame: Wt ax ay az frame rt wt wx wy wz
non-const: x y z
point: a b node rc rigid
polar fluid body moment: moment
radial force: c p sx sy sz
sbm point source: rate sbm weigh_volume x y z
solute point source: rate solute x y z
surface attraction: blt bsf search_radius search_tol surface
# ic
displacement: value
init_dof: dof value
initial concentration: dof value
initial fluid angular velocity: value
initial fluid dilatation: value
initial fluid pressure: value
initial fluid pressure and temperature: pressure temperature
initial fluid temperature: value
initial fluid velocity: value
initial shell concentration: dof value
initial shell fluid pressure: value
initial_rigid_angular_velocity: rb value
initial_rigid_velocity: rb value
prestrain: init reset
rigid kinematics: angular_velocity center_of_rotation velocity
shell velocity: value
velocity: value
# load
axial force: axis c p scale
bearing load: force linear profile scale shell_bottom symmetric_stiffness
biphasic-FSI traction: shell_bottom
body force: force
centrifugal: angular_speed rotation_axis rotation_center
const: x y z
constant fluid heat supply: r
fluid RC: Bernoulli R capacitance initial_pressure
fluid RCR: R Rd capacitance initial_pressure pressure_offset
fluid backflow stabilization: beta
fluid body force: force
fluid centrifugal force: angular_speed rotation_axis rotation_center
fluid heat flux: flux
fluid mixture viscous traction: scale traction
fluid moving frame: Wt ax ay az frame rt wt wx wy wz
fluid natural heat flux:
fluid normal traction: traction
fluid normal velocity: parabolic prescribe_nodal_velocities prescribe_rim_pressure velocity
fluid pressure: pressure
fluid resistance: R pressure_offset
fluid tangential damping: penalty
fluid tangential stabilization: beta
fluid velocity: scale velocity
fluid viscous traction: scale traction
fluid-FSI traction: shell_bottom
fluidflux: flux linear mixture shell_bottom
force: force scale shell_bottom
ideal gas pressure: P0 shell_bottom symmetric_stiffness
mass damping: C
matching_osm_coef: ambient_osmolarity ambient_pressure shell_bottom
moving frame: Wt ax ay az frame rt wt wx wy wz
multiphasic-FSI traction: shell_bottom
nodal fluidflux: relative value
nodal_force: relative shell_bottom value
nodal_load: dof relative scale
nodal_target_force: force scale shell_bottom
non-const: x y z
normal_traction: effective linear shell_bottom traction
pipette aspiration: center normal pressure radius
point: a b node rc rigid
polar fluid body moment: moment
pressure: linear pressure shell_bottom symmetric_stiffness
pressure Robin BC: dashpot_eps shell_bottom spring_eps
pressure_stabilization: stabilize
radial force: c p sx sy sz
rigid_axial_force: force ra rb rbA rbB relative
rigid_cable: force force_direction relative rigid_cable_point
rigid_follower_force: force insertion rb relative
rigid_follower_moment: moment rb
rigid_force: dof load_type rb relative value
rigid_moment: dof load_type rb relative value
sbm point source: rate sbm weigh_volume x y z
solute backflow stabilization: sol solute_id
solute convective flow: solute_id
solute flux: flux sol solute_id
solute natural flux: shell_bottom solute_id update
solute point source: rate solute x y z
soluteflux: flux linear shell_bottom solute_id
surface attraction: blt bsf search_radius search_tol surface
temperature backflow stabilization:
traction: linear scale shell_bottom traction
traction Robin BC: dashpot_eps shell_bottom spring_eps
# contact
contact potential: R0_min R_in R_out check_intersections integration_rule kc laugon max_penalty_sf p
  penalty_sf w_tol
mortar-sliding: max_penalty_sf maxaug minaug penalty penalty_sf tolerance
mortar-tied: max_penalty_sf maxaug minaug penalty penalty_sf tolerance
periodic boundary: laugon max_penalty_sf minaug offset penalty penalty_sf tolerance two_pass
periodic boundary1O: laugon max_penalty_sf minaug offset penalty penalty_sf tolerance two_pass
periodic boundary2O: laugon max_penalty_sf minaug offset penalty penalty_sf tolerance two_pass
sliding-biphasic: auto_penalty contact_frac flip_primary flip_secondary fric_coeff gaptol knmult laugon
  max_penalty_sf maxaug minaug node_reloc penalty penalty_sf pressure_penalty ptol search_radius
  search_tol seg_up shell_bottom_primary shell_bottom_secondary smooth_aug smooth_fls symmetric_stiffness
  tolerance two_pass update_penalty
sliding-biphasic-mixed: auto_penalty contact_frac flip_primary flip_secondary fric_coeff gaptol knmult
  laugon max_penalty_sf maxaug minaug node_reloc penalty penalty_sf pressure_penalty ptol search_radius
  search_tol seg_up shell_bottom_primary shell_bottom_secondary smooth_aug smooth_fls symmetric_stiffness
  tolerance two_pass update_penalty
sliding-biphasic-solute: ambient_concentration ambient_pressure auto_penalty concentration_penalty ctol
  gaptol knmult laugon max_penalty_sf maxaug minaug node_reloc penalty penalty_sf pressure_penalty ptol
  search_radius search_tol seg_up smooth_aug symmetric_stiffness tolerance two_pass update_penalty
sliding-elastic: auto_penalty flip_primary flip_secondary fric_coeff gaptol knmult laugon max_penalty_sf
  maxaug minaug node_reloc offset penalty penalty_sf search_radius search_tol seg_up shell_bottom_primary
  shell_bottom_secondary smooth_aug symmetric_stiffness tension tolerance two_pass update_penalty
sliding-facet-on-facet: auto_penalty dxtol fric_coeff fric_penalty gaptol knmult laugon max_penalty_sf
  maxaug minaug node_reloc penalty penalty_sf search_radius search_tol seg_up smooth_aug tolerance
  two_pass update_penalty
sliding-multiphasic: ambient_concentration ambient_pressure auto_penalty concentration_penalty
  contact_frac ctol fric_coeff gaptol knmult laugon max_penalty_sf maxaug minaug node_reloc penalty
  penalty_sf pressure_penalty ptol search_radius search_tol seg_up smooth_aug smooth_fls
  symmetric_stiffness tolerance two_pass update_penalty
sliding-node-on-facet: auto_penalty fric_coeff fric_penalty gaptol knmult ktmult laugon max_penalty_sf
  maxaug minaug node_reloc penalty penalty_sf search_radius search_tol seg_up tolerance two_pass
  update_penalty
sliding2: auto_penalty dual_proj gaptol knmult laugon max_penalty_sf maxaug minaug node_reloc penalty
  penalty_sf pressure_penalty ptol search_radius search_tol seg_up smooth_aug symmetric_stiffness
  tolerance two_pass update_penalty
sticky: flip_secondary gap_offset laugon max_penalty_sf max_traction maxaug minaug penalty penalty_sf
  search_tolerance snap_tol tolerance
surface constraint: laugon max_penalty_sf penalty penalty_sf tolerance two_pass
tied-biphasic: auto_penalty gaptol knmult laugon max_penalty_sf maxaug minaug penalty penalty_sf
  pressure_penalty ptol search_radius search_tol symmetric_stiffness tolerance two_pass update_penalty
tied-elastic: auto_penalty flip_primary flip_secondary gaptol knmult laugon max_penalty_sf maxaug minaug
  penalty penalty_sf search_radius search_tol symmetric_stiffness tolerance two_pass update_penalty
tied-facet-on-facet: gap_offset laugon max_penalty_sf maxaug minaug penalty penalty_sf search_tolerance
  tolerance
tied-fluid: auto_penalty free_dofs gaptol laugon max_penalty_sf maxaug minaug penalty penalty_sf
  pressure_penalty ptol search_radius search_tol tolerance two_pass
tied-multiphasic: auto_penalty concentration_penalty ctol gaptol knmult laugon max_penalty_sf maxaug
  minaug penalty penalty_sf pressure_penalty ptol search_radius search_tol symmetric_stiffness tolerance
  two_pass update_penalty
tied-node-on-facet: laugon max_distance max_penalty_sf maxaug minaug node_reloc offset_shells penalty
  penalty_sf search_tolerance special tolerance
# constraint
2O microfluc: augtol laugon penalty
azimuth constraint: augtol laugon maxaug minaug penalty
discrete contact: altol gaptol laugon maxaug minaug penalty segup
discrete contact2:
edge-to-surface contact potential: R0_min R_in R_out edgelist kc p w_tol
edge-to-surface sliding contact: edgelist maxaug minaug penalty search_radius search_tol seg_up tolerance
fixed normal displacement: laugon maxaug minaug penalty rhs shell_bottom tol
fluid pressure constraint: laugon maxaug minaug penalty pressure tol
frictionless fluid wall: laugon maxaug minaug penalty rhs tol
generic rigid joint: body_a body_b joint laugon penalty prescribe_Rx prescribe_Ry prescribe_Rz prescribe_x
  prescribe_y prescribe_z symmetric_stiffness tolerance
in-situ stretch: isochoric max_iters max_stretch min_iters tolerance update
linear constraint: laugon linear_constraint maxaug minaug penalty rhs tol
node distance: augtol laugon maxaug minaug node penalty relative target
node-on-node: a b
normal fluid flow: laugon maxaug minaug penalty rhs tol
point: node penalty
prestrain: max_iters min_iters tolerance update
rigid angular damper: body_a body_b c
rigid contractile force: body_a body_b f0 insertion_a insertion_b
rigid cylindrical joint: angtol auto_penalty body_a body_b force force_penalty gaptol joint_axis
  joint_origin laugon maxaug minaug moment moment_penalty prescribed_rotation prescribed_translation
  rotation tolerance translation transverse_axis
rigid damper: body_a body_b c insertion_a insertion_b
rigid joint: body_a body_b joint laugon penalty tolerance
rigid lock: angtol auto_penalty body_a body_b first_axis force_penalty gaptol joint_origin laugon maxaug
  minaug moment_penalty second_axis tolerance
rigid planar joint: angtol auto_penalty body_a body_b force_penalty gaptol joint_origin laugon maxaug
  minaug moment_penalty prescribed_rotation prescribed_translation_1 prescribed_translation_2 rotation
  rotation_axis tolerance translation_1 translation_2 translation_axis_1
rigid prismatic joint: angtol auto_penalty body_a body_b force force_damping force_penalty gaptol
  joint_origin laugon maxaug minaug moment_damping moment_penalty prescribed_translation tolerance
  translation translation_axis transverse_axis
rigid revolute joint: angtol auto_penalty body_a body_b force_damping force_penalty gaptol joint_origin
  laugon maxaug minaug moment moment_damping moment_penalty prescribed_rotation rotation rotation_axis
  tolerance torsion_stiffness transverse_axis
rigid spherical joint: angtol auto_penalty body_a body_b force_penalty gaptol joint_origin laugon maxaug
  minaug moment_penalty moment_x moment_y moment_z prescribed_rotation rotation_x rotation_y rotation_z
  tolerance
rigid spring: body_a body_b free_length insertion_a insertion_b k
rigid_wall: laugon offset penalty plane tolerance
slide-line: gaptol laugon maxaug minaug penalty primary secondary seg_up tolerance
symmetry plane: laugon maxaug minaug penalty rhs tol
tied-line: laugon max_distance maxaug minaug penalty primary secondary tolerance
uniform fluid flow: laugon maxaug minaug penalty tol
volume: augtol laugon penalty
# load_controller
PID: Kd Ki Kp target var
loadcurve: extend interpolate points
math: math var
math-interval: interval left_extend math right_extend var
# mesh_adaptor
erosion: criterion erode_surfaces max_elems max_iters remove_islands sort
fsi-volume-erosion: max_elems max_iters metric min_volume_ratio
hex_refine: criterion map_data max_elem_refine max_elements max_iters max_value nnc nsdim transfer_method
hex_refine2d: criterion map_data max_elem_refine max_elements max_iters max_value nnc nsdim transfer_method
mmg_remesh: criterion gradation hausdorff map_data max_elements max_iters mesh_coarsen min_element_size
  nnc normalize_data nsdim relative_size size_function transfer_method
test_refine: map_data max_elements max_iters nnc nsdim transfer_method
tet_refine: map_data max_elements max_iters nnc nsdim transfer_method
# analysis
biphasic: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range
  plot_stride plot_zero_state solver step_size time_stepper time_steps
fluid: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range plot_stride
  plot_zero_state solver step_size time_stepper time_steps
fluid-FSI: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range
  plot_stride plot_zero_state solver step_size time_stepper time_steps
fluid-solutes: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range
  plot_stride plot_zero_state solver step_size time_stepper time_steps
multiphasic: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range
  plot_stride plot_zero_state solver step_size time_stepper time_steps
multiphasic-FSI: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range
  plot_stride plot_zero_state solver step_size time_stepper time_steps
polar fluid: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range
  plot_stride plot_zero_state solver step_size time_stepper time_steps
solid: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range plot_stride
  plot_zero_state solver step_size time_stepper time_steps
solute: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range plot_stride
  plot_zero_state solver step_size time_stepper time_steps
thermo-fluid: adaptor_re_solve analysis final_time output_level output_stride plot_level plot_range
  plot_stride plot_zero_state solver step_size time_stepper time_steps
# solver
CG-solid: beta cgmethod dtol equation_order equation_scheme etol gamma lsiter lsmin lstol min_residual
  optimize_bw preconditioner rtol symmetric_stiffness
biphasic: alpha arc_length arc_length_scale beta check_zero_diagonal ctol diverge_reform dtol
  equation_order equation_scheme etol force_partition gamma linear_solver logSolve ls_check_jacobians
  lsiter lsmin lstol max_refs max_residual min_residual mixed_formulation optimize_bw ptol qn_method
  reform_augment reform_each_time_step rhoi rtol symmetric_stiffness zero_diagonal_tol
explicit-solid: dyn_damping equation_order equation_scheme mass_lumping optimize_bw symmetric_stiffness
fluid: check_zero_diagonal diverge_reform equation_order equation_scheme etol force_partition ftol
  linear_solver ls_check_jacobians lsiter lsmin lstol max_refs max_residual min_residual min_volume_ratio
  optimize_bw predictor qn_method reform_augment reform_each_time_step rhoi rtol symmetric_stiffness vtol
  zero_diagonal_tol
fluid-FSI: check_zero_diagonal diverge_reform dtol equation_order equation_scheme etol force_partition
  ftol linear_solver ls_check_jacobians lsiter lsmin lstol max_refs max_residual min_residual
  min_volume_ratio optimize_bw order predictor qn_method reform_augment reform_each_time_step rhoi rtol
  symmetric_stiffness vtol zero_diagonal_tol
fluid-solutes: check_zero_diagonal ctol diverge_reform equation_order equation_scheme etol force_partition
  force_positive_concentrations ftol linear_solver ls_check_jacobians lsiter lsmin lstol max_refs
  max_residual min_C_drop min_C_num min_C_rise min_residual min_volume_ratio optimize_bw predictor
  qn_method reform_augment reform_each_time_step rhoi rtol solve_strategy symmetric_stiffness vtol
  zero_diagonal_tol
multiphasic: alpha arc_length arc_length_scale beta check_zero_diagonal ctol diverge_reform dtol
  equation_order equation_scheme etol force_partition force_positive_concentrations gamma linear_solver
  logSolve ls_check_jacobians lsiter lsmin lstol max_refs max_residual min_residual optimize_bw ptol
  qn_method reform_augment reform_each_time_step rhoi rtol symmetric_stiffness zero_diagonal_tol
multiphasic-FSI: check_zero_diagonal ctol diverge_reform dtol equation_order equation_scheme etol
  force_partition force_positive_concentrations ftol linear_solver ls_check_jacobians lsiter lsmin lstol
  max_refs max_residual min_residual min_volume_ratio optimize_bw order predictor qn_method reform_augment
  reform_each_time_step rhoi rtol symmetric_stiffness vtol zero_diagonal_tol
polar fluid: check_zero_diagonal diverge_reform equation_order equation_scheme etol force_partition ftol
  gtol linear_solver ls_check_jacobians lsiter lsmin lstol max_refs max_residual min_residual
  min_volume_ratio optimize_bw order predictor qn_method reform_augment reform_each_time_step rhoi rtol
  symmetric_stiffness vtol zero_diagonal_tol
solid: alpha arc_length arc_length_scale beta check_zero_diagonal diverge_reform dtol equation_order
  equation_scheme etol force_partition gamma init_accelerations linear_solver logSolve ls_check_jacobians
  lsiter lsmin lstol max_refs max_residual min_residual optimize_bw qn_method reform_augment
  reform_each_time_step rhoi rtol symmetric_stiffness zero_diagonal_tol
solid_old: beta check_zero_diagonal diverge_reform dtol equation_order equation_scheme etol
  force_partition gamma linear_solver ls_check_jacobians lsiter lsmin lstol max_refs max_residual
  min_residual optimize_bw qn_method reform_augment reform_each_time_step rtol symmetric_stiffness
  use_new_rigid_update zero_diagonal_tol
solute: alpha arc_length arc_length_scale beta check_zero_diagonal ctol diverge_reform dtol equation_order
  equation_scheme etol force_partition gamma linear_solver logSolve ls_check_jacobians lsiter lsmin lstol
  max_refs max_residual min_residual mixed_formulation optimize_bw ptol qn_method reform_augment
  reform_each_time_step rhoi rtol symmetric_stiffness zero_diagonal_tol
solutes: check_zero_diagonal ctol diverge_reform equation_order equation_scheme etol force_partition
  force_positive_concentrations linear_solver ls_check_jacobians lsiter lsmin lstol max_refs max_residual
  min_residual optimize_bw predictor qn_method reform_augment reform_each_time_step rhoi rtol
  symmetric_stiffness zero_diagonal_tol
thermo-fluid: check_zero_diagonal diverge_reform equation_order equation_scheme etol force_partition ftol
  linear_solver ls_check_jacobians lsiter lsmin lstol max_refs max_residual min_T_drop min_T_num
  min_T_rise min_abs_temperature min_residual min_volume_ratio optimize_bw predictor qn_method
  reform_augment reform_each_time_step rhoi rtol solve_strategy symmetric_stiffness ttol vtol
  zero_diagonal_tol
# domain
biphasic-FSI-3D: mat_axis
biphasic-shell: mat_axis secant_permeability_tangent secant_stress secant_tangent shell_normal_nodal
  shell_thickness
biphasic-solid: mat_axis secant_permeability_tangent secant_stress secant_tangent
biphasic-solute-shell: mat_axis shell_normal_nodal shell_thickness
biphasic-solute-solid: mat_axis
deformable-spring: k_bend k_stab
deformable-spring2:
discrete:
elastic-mm-solid: mat_axis
elastic-mm-solid2O: mat_axis
elastic-shell: mat_axis secant_stress secant_tangent shell_normal_nodal shell_thickness
elastic-shell-ans: mat_axis secant_stress secant_tangent shell_normal_nodal shell_thickness
elastic-shell-eas: mat_axis secant_stress secant_tangent shell_normal_nodal shell_thickness
elastic-shell-old: mat_axis
elastic-solid: elem_type mat_axis secant_stress secant_tangent
elastic-solid2O: mat_axis
elastic-truss: cross_sectional_area v
fluid-FSI-3D: mat_axis
fluid-solutes-3D: mat_axis
linear-beam:
linear-truss: cross_sectional_area
multiphasic-FSI-3D: mat_axis
multiphasic-shell: mat_axis shell_normal_nodal shell_thickness
multiphasic-solid: mat_axis
remodeling-solid: mat_axis
rigid-shell: mat_axis shell_thickness
rigid-shell-old: mat_axis
rigid-solid: mat_axis
sri-solid: mat_axis
three-field-shell: atol laugon mat_axis maxaug minaug secant_stress secant_tangent shell_normal_nodal
  shell_thickness
three-field-solid: atol laugon mat_axis maxaug minaug
triphasic-solid: mat_axis
udg-hex: hg mat_axis
ut4-solid: alpha iso_stab mat_axis
# map
defgrad: node_displacement_map
image map: blur image range_max range_min
math: math
parabolic map: value
surface-to-surface map: bottom_surface function top_surface
surface-to-surface vector: cross in_angle normal out_angle smooth_iters surface1 surface2
# other
BFGS: cmax cycle_buffer max_buffer_size max_ups
Bingham: mu n tauy
Broyden: cmax cycle_buffer max_buffer_size max_ups
CDF Simo: Dmax a b
CDF Weibull: Dmax alpha mu ploc
CDF gamma: Dmax alpha mu
CDF log-normal: Dmax mu sigma
CDF quintic: Dmax mumax mumin
CDF step: Dmax mu
CDF user: Dmax cdf
Carreau: lambda mu0 mui n
Carreau-Yasuda: a lambda mu0 mui n
Cross: lambda m mu0 mui
DC Deshpande-Fleck: beta
DC Drucker shear stress: c
DC Drucker-Prager: b
DC Simo:
DC max normal Lagrange strain:
DC max normal stress:
DC max shear stress:
DC octahedral natural strain:
DC octahedral shear strain:
DC specific strain energy:
DC strain energy density:
DC von Mises stress:
FFTW blur: blur normalize_values voxel_resolution
Huiskes reaction rate: B D psi0
Huiskes-supply: B D k
JFNK: jfnk_eps
LU:
Michaelis-Menten: Km Vbar c0 forward_rate override_vbar vP vR
Newtonian fluid: kappa khat mu muhat
Newtonian real vapor: C0 C1 C2 C3 esat mu musat
Nims reaction rate: cc cr k0 kc kr sol trel
PFC math: e0 emax nf plastic_response
PFC paper: Y0 Ymax nf r w0 we
PFC user: plastic_response
Powell-Eyring: lambda mu0 mui
Quemada: H gc k0 kinf mu0
Ruberti reaction rate: kd sigma
Starling: kp pv
accelerate: atol factorization iterative iterative_method max_iter order_method print_condition_number
  print_level rtol
active-const-supply: supply
active_contraction: Tmax ascl beta ca0 camax l0 refl
ambient_concentration: ambient_concentration sol
angles: phi theta
area growth: fiber multiplier
bicgstab: fail_max_iters max_iter pc_left print_level tol
bipn: cg_check_residual cg_maxiter cg_tol do_jacobi gmres_check_residual gmres_maxiter gmres_precondition
  gmres_tol maxiter precondition_schur print_level tol use_cg
block: fail_max_iter max_iter print_level solution_method tol zero_initial_guess
boomeramg: agg_interp_type agg_num_levels coarsen_type do_jacobi fail_max_iters interp_type max_iter
  max_levels nodal num_sweeps p_max_elmts print_level relax_type strong_threshold tol use_num_funcs
box blur: blur iterations normalize_values voxel_resolution
cg: fail_max_iters max_iter pc_left print_level tol
child_dof: dof node value
circular:
concentration-independent: Vbar forward_rate override_vbar vP vR
const: const value
constant reaction rate: k
constant thermal conductivity: K
constrained levmar: f_diff_scale max_iter obj_tol scale_parameters tau
contact gap: gap
cylindrical: axis center vector
damage:
default: aggressiveness cutback dtforce dtmax dtmin max_retries opt_iter
diagonal:
diff-Albro-iso: alphad cdinv free_diff
diff-const-iso: diff free_diff
diff-const-ortho: diff free_diff
diff-ref-iso: M alpha diff0 diff1 diff2 free_diff
element data: element_data
element_data:
element_selection: element_list value
ellipsoidal: spa
elliptical: spa1 spa2
exp-sed reaction rate: B Psi0
face_data:
feast: emax emin m0
fgmres: abs_tol check_residual fail_max_iters max_iter max_restart pc_left pc_right print_level tol
fiber growth: fiber multiplier
fiber-CDF: E cdf epsf
fiber-CDF-uncoupled: E cdf epsf
fiber-NH: mu
fiber-NH-uncoupled: mu
fiber-entropy-chain: N ksi mu n_term
fiber-exp-linear: c3 c4 c5 lambda
fiber-exp-pow: alpha beta ksi lam0 mu
fiber-exp-pow-linear: E alpha beta lam0
fiber-exp-pow-uncoupled: alpha beta ksi mu
fiber-natural-NH: ksi lam0
fiber-odf: position shp_harmonics
fiber-pow: beta ksi tension_only
fiber-pow-linear: E beta lam0 tension_only
fiber-pow-linear-uncoupled: E beta lam0
fibers-2d-trapezoidal: nth
fibers-3d-fei: resolution
fibers-3d-gauss: nph nth
fibers-3d-geodesic: resolution
fibers-3d-gkt: nph nth
fluid shear stress:
fluid-3D:
force-velocity-Estrada: A1 A2 A3 Tmax a_t alpha1 alpha2 alpha3 ascl beta ca0 camax force_velocity l0 refl
full Newton:
general growth: ani fiber iso
generation: solid start_time
hypre_gmres: maxiter print_level tol
hypre_pcg_amg: amg_tol maxiter print_level tol
ichol:
ideal gas: M ao ar cp sr
ideal gas isentropic: M cv0 gamma
ilu0: replace_zero_diagonal zero_replace zero_threshold
ilut: filltol maxfill replace_zero_diagonal zero_replace zero_threshold
image map: image range_max range_min transform
in-situ stretch: isochoric stretch
iterative blur: blur normalize_values
levmar: f_diff_scale max_iter obj_tol print_cov
linear:
linear ramp: intercept slope
linear_constraint: node
local: local
log-nonlinear:
map: map
mass-action-forward: Vbar forward_rate override_vbar vP vR
mass-action-forward-effective: Vbar forward_rate override_vbar vP vR
mass-action-reversible: Vbar forward_rate override_vbar reverse_rate vP vR
mass-action-reversible-effective: Vbar forward_rate override_vbar reverse_rate vP vR
math: math
max_variable: dof
membrane constant reaction rate: k
membrane ion channel reaction rate: g sbm sol
membrane voltage-gated reaction rate: a b c d sol
membrane-mass-action-forward: Vbar forward_rate override_vbar vP vPe vPi vR vRe vRi
membrane-mass-action-reversible: Vbar forward_rate override_vbar reverse_rate vP vPe vPi vR vRe vRi
min-max filter: clamp data max min
mkl_dss: msglvl
modified Newton:
node: bc id node
node_data:
nonlinear:
nrrd: file
optimize:
osm-coef-Manning: co_ion ksi osmc
osm-coef-const: osmcoef
param_run:
parameter_sweep:
pardiso: msglvl precondition print_condition_number
pardiso-project: precondition print_condition_number
pardiso_64: msglvl precondition
perm-Holmes-Mow: M alpha perm
perm-const-iso: perm
perm-exp-iso: M perm
perm-ref-iso: M alpha perm0 perm1 perm2
perm-ref-ortho: M M0 alpha alpha0 perm0 perm1 perm2
perm-ref-trans-iso: M0 MA MT alpha0 alphaA alphaT perm0 perm1A perm1T perm2A perm2T
point: extend interpolate log points
polar: axis center radius1 radius2 vector1 vector2
polar linear: alpha beta gamma tau
polar-fluid-3D:
powell:
prestrain gradient: F0 ramp
probe: debug element_id file gausspt
raw: endianess file format size
rci_solve:
real gas: A1 A2 A3 A4 A5 A6 A7 C0 C1 C2 C3 a0 nva nvc
real liquid: B1 B2 B3 C1 C2 C3 asat cvsat esat nvc psat ssat
real vapor: C0 C1 C2 C3 D0 D1 D2 D3 D4 D5 D6 Tc asat cvsat esat psat ssat
real vapor thermal conductivity: C0 C1 C2 C3 Kr Ksat esat
recruitment Weibull: alpha max mu ploc
recruitment exponential: alpha mu0 mu1 scale
recruitment gamma: alpha max mu
recruitment log-normal: max mu sigma
recruitment polynomial: mu0 mu1 mu2
recruitment power: alpha mu0 mu1 scale
recruitment quintic: max mumax mumin
recruitment user: function
relative error: data error
relative volume:
relaxation-CSexp: tau
relaxation-CSexp-dist-user: tau
relaxation-Carreau: lambda n tau0
relaxation-Fung: tau1 tau2
relaxation-Malkin: beta tau1 tau2
relaxation-Malkin-dist-user: beta tau1 tau2
relaxation-Malkin-distortion: beta t1c0 t1c1 t1s0 t2c0 t2c1 t2s0
relaxation-Park: beta tau
relaxation-Park-dist-user: beta tau
relaxation-Park-distortion: alpha beta0 beta1 tau0 tau1
relaxation-Prony: g1 g2 g3 g4 g5 g6 t1 t2 t3 t4 t5 t6
relaxation-exp-dist-user: tau
relaxation-exp-distortion: alpha tau0 tau1
relaxation-exponential: tau
relaxation-power: beta tau
relaxation-power-dist-user: beta tau
relaxation-power-distortion: alpha beta0 beta1 tau0 tau1
restart:
rigid_body_data:
rigid_cable_point: position rigid_body_id
rigid_connector_data:
scale: scale
scan:
schur: A_solver do_jacobi print_level schur_A_solver schur_block schur_pc schur_solver zero_D_block
skyline:
solid_bound: charge_number density molar_mass rho0 rhomax rhomin sbm
solub-Manning: co_ion ksi solub
solub-const: solub
solute: charge_number density diffusivity molar_mass sol solubility supply
solute-as-sbm reaction rate: k0
solutes-3D:
solve:
spherical: center vector
spring force:
spring stretch:
step: left_val right_val x0
strategy: max_condition_number print_condition_number solver1 solver2 strategy
stress: metric
structure-tensor: spd
superlu_mt: nprocs permc_spec
supply-Michaelis-Menten: Km Vmax
supply-binding: Rtot kf kr
supply-const: supp
supply-synthesis-binding: Rtot kf kr supp
surface:
temp-dependent thermal conductivity: Khat Kr
test:
thermo-fluid-3D:
uncoupled active_contraction: Tmax ascl beta ca0 camax l0 refl
uncoupled fiber-entropy-chain: N ksi n_term
uncoupled fiber-exp-linear: c3 c4 c5 lambda
user:
vP: sbm sol species vP
vPe: sbm sol species vPe
vPi: sbm sol species vPi
vR: sbm sol species vR
vRe: sbm sol species vRe
vRi: sbm sol species vRi
vector: a d vector
volume growth: fiber multiplier
von-Mises-2d: b
von-Mises-3d: b
von-Mises-3d-two-axisym: b cosg
# plot
Almansi strain; Deshpande-Fleck stress; Drucker shear stress; Drucker-Prager stress; Euler angle; G norm;
  Lagrange strain; PK1 norm; PK1 stress; PK2 stress; QK1 norm; RVE generations; RVE recruitment; RVE
  reforming bonds; RVE strain; SPR Lagrange strain; SPR infinitesimal strain; SPR prestrain correction;
  SPR principal stress; SPR relative volume; SPR stress; SPR-P1 stress; acceleration; beam curvature; beam
  reference stress; beam reference stress couple; beam strain; beam stress; beam stress couple; body
  force; concentration gap; contact area; contact force; contact gap; contact penalty; contact pressure;
  contact status; contact stick; contact traction; continuous damage; continuous damage D1; continuous
  damage D2; continuous damage D2beta; continuous damage D3; continuous damage Ds; continuous damage P;
  continuous damage Psi0; continuous damage beta; continuous damage gamma; current density; current
  element angular momentum; current element center of mass; current element kinetic energy; current
  element linear momentum; current element strain energy; damage; deformation gradient; density;
  deviatoric elasticity; deviatoric fiber stretch; deviatoric strain energy density; deviatoric strong
  bond SED; deviatoric weak bond SED; dilatation gradient; discrete element direction; discrete element
  elongation; discrete element force; discrete element length; discrete element percent elongation;
  discrete element signed force; discrete element strain energy; discrete element stretch; displacement;
  edge contact gap; effective elasticity; effective fluid pressure; effective friction coefficient;
  effective shell fluid pressure; effective shell solute concentration; effective solute concentration;
  elastic fluid pressure; elasticity; electric potential; element angular momentum; element center of
  mass; element kinetic energy; element linear momentum; element strain energy; element stress power;
  enclosed volume; enclosed volume change; facet area; fatigue bond fraction; fiber stretch; fiber vector;
  field; fixed charge density; fluid acceleration; fluid body force; fluid bulk modulus; fluid density;
  fluid density rate; fluid dilatation; fluid element angular momentum; fluid element center of mass;
  fluid element kinetic energy; fluid element linear momentum; fluid element strain energy; fluid energy
  density; fluid flow rate; fluid flux; fluid force; fluid force2; fluid heat flux; fluid heat supply
  density; fluid isobaric specific heat capacity; fluid isochoric specific heat capacity; fluid kinetic
  energy density; fluid load support; fluid mass flow rate; fluid pressure; fluid pressure tangent strain;
  fluid pressure tangent temperature; fluid rate of deformation; fluid relative Reynolds number; fluid
  relative thermal Peclet number; fluid shear stress error; fluid shear viscosity; fluid specific entropy;
  fluid specific free energy; fluid specific free enthalpy; fluid specific gauge enthalpy; fluid specific
  internal energy; fluid specific strain energy; fluid strain energy density; fluid stress; fluid stress
  power density; fluid surface energy flux; fluid surface force; fluid surface moment; fluid surface
  pressure; fluid surface traction power; fluid temperature; fluid thermal conductivity; fluid velocity;
  fluid volume ratio; fluid volume ratio gradient; fluid vorticity; growth Lagrange strain; growth
  infinitesimal strain; growth left Hencky; growth left stretch; growth relative volume; growth right
  Hencky; growth right stretch; ideal gas pressure; in-situ target stretch; incremental displacement;
  infinitesimal strain; intact bond fraction; kinetic energy density; left Cauchy-Green; left Hencky; left
  stretch; local fluid load support; material axes; mesh_data; micro energy; mixture deviatoric strain
  energy density; mixture specific strain energy; mixture strain energy density; mixture stress;
  mortar-gap; nodal acceleration; nodal contact gap; nodal contact pressure; nodal contact traction; nodal
  fluid flux; nodal fluid temperature; nodal fluid velocity; nodal polar fluid angular velocity; nodal
  shell director; nodal strain; nodal stress; nodal surface traction; nodal vector gap; nodal velocity;
  octahedral plastic strain; osmolarity; osmotic coefficient; parameter; partition coefficient;
  permeability; pid controller; plastic yield stress; plasticity heat supply density; polar fluid angular
  velocity; polar fluid couple stress; polar fluid regional angular velocity; polar fluid relative angular
  velocity; polar fluid stress; porosity; pressure gap; prestrain compatibility; prestrain correction;
  prestrain stretch; prestrain stretch error; rate of deformation; reaction forces; receptor-ligand
  concentration; referential fixed charge density; referential solid volume fraction; relative fluid
  velocity; relative volume; right Cauchy-Green; right Hencky; right stretch; rigid acceleration; rigid
  angular acceleration; rigid angular momentum; rigid angular position; rigid angular velocity; rigid
  force; rigid kinetic energy; rigid linear momentum; rigid position; rigid rotation vector; rigid torque;
  rigid velocity; rotation; s norm; sbm areal concentration; sbm concentration; sbm referential apparent
  density; scalar surface load; shell bottom nodal strain; shell bottom nodal stress; shell bottom strain;
  shell bottom stress; shell director; shell displacement; shell relative volume; shell strain; shell
  thickness; shell top nodal strain; shell top nodal stress; shell top strain; shell top stress; solid
  stress; solid volume fraction; solute concentration; solute flux; solute relative Peclet number; solute
  volumetric flux; specific strain energy; strain energy density; stress; stress error; strong bond SED;
  surface area; surface reaction force; surface reaction moment; surface traction; total angular momentum;
  total energy; total linear momentum; truss stretch; uncoupled pressure; ut4 nodal stress; vector gap;
  velocity; volume fraction; weak bond SED; yielded bond fraction
# log
D; E1; E2; E3; EulerX; EulerY; EulerZ; Ex; Exy; Exz; Ey; Eyz; Ez; FHAsx; FHAsy; FHAsz; FHAtd; FHAwm;
  FHAwx; FHAwy; FHAwz; Fde.x; Fde.y; Fde.z; Fx; Fxx; Fxy; Fxz; Fy; Fyx; Fyy; Fyz; Fz; Fzx; Fzy; Fzz; H1;
  H2; H3; Hx; Hxy; Hxz; Hy; Hyz; Hz; IHAsx; IHAsy; IHAsz; IHAtd; IHAwm; IHAwx; IHAwy; IHAwz; Iex; Iey;
  Iez; J; KE; Mx; My; Mz; Pxx; Pxy; Pxz; Pyx; Pyy; Pyz; Pzx; Pzy; Pzz; R11; R12; R13; R21; R22; R23; R31;
  R32; R33; RCFx; RCFy; RCFz; RCMx; RCMy; RCMz; RCthx; RCthy; RCthz; RCx; RCy; RCz; Rx; Ry; Rz; Sx; Sxy;
  Sxz; Sy; Syz; Sz; U1; U2; U3; Ux; Uxy; Uxz; Uy; Uyz; Uz; V; V1; V2; V3; Vx; Vxy; Vxz; Vy; Vyz; Vz;
  _math; alx; aly; alz; avg; ax; ay; az; c; cF; constrained volume; contact area; contact gap; contact
  pressure; contact_traction.x; contact_traction.y; contact_traction.z; crc; devsed; discrete element
  elongation; discrete element force; discrete element stretch; effective left Hencky; effective left
  stretch; effective right Hencky; effective right stretch; effective strain; effective stress; ex; exy;
  exz; ey; eyz; ez; fJ; facet area; fax; fay; faz; fd; fdxx; fdxy; fdxz; fdyy; fdyz; fdzz; fiber_stretch;
  fmxs; fp; fs1; fs2; fs3; fsp; fsxx; fsxy; fsxz; fsyy; fsyz; fszz; fvx; fvy; fvz; fwx; fwy; fwz; fx; fy;
  fz; h1; h2; h3; hx; hxy; hxz; hy; hyz; hz; integrate; jx; jy; jz; max contact gap; nfvx; nfvy; nfvz;
  normalized internal energy; omx; omy; omz; ops; p; pct; pe; porosity; psi; qw; qx; qy; qz; rcFHAsx;
  rcFHAsy; rcFHAsz; rcFHAtd; rcFHAwm; rcFHAwx; rcFHAwy; rcFHAwz; rcIHAsx; rcIHAsy; rcIHAsz; rcIHAtd;
  rcIHAwm; rcIHAwx; rcIHAwy; rcIHAwz; s1; s2; s3; sed; solution_norm; sx; sxy; sxz; sy; syz; sz; thx; thy;
  thz; total energy; ux; uy; uz; volume; volume change; volume pressure; vx; vy; vz; wf; wi; wx; wy; wz;
  x; y; z
"""


class Types(Mapping[str, frozenset[str]]):
    """Parameters by type; a type's row is read when it is asked for."""

    def __init__(self, rows: dict[str, str]) -> None:
        self.rows = rows

    def __getitem__(self, name: str) -> frozenset[str]:
        return frozenset(self.rows[name].split())

    def __contains__(self, name: object) -> bool:
        return name in self.rows

    def __iter__(self) -> Iterator[str]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)


@cache
def table() -> dict[str, Types]:
    """Parameters by kind and type; for "plot" and "log" the types alone."""
    out: dict[str, Types] = {}
    for block in TABLE.strip().replace("\n  ", " ").removeprefix("# ").split("\n# "):
        kind, *lines = block.split("\n")
        if kind in ("plot", "log"):
            rows = dict.fromkeys((t.strip() for line in lines for t in line.split(";")), "")
        else:
            rows = {name.rstrip(":"): row for name, _, row in (line.partition(": ") for line in lines)}
        out[kind] = Types(rows)
    return out


@cache
def anywhere() -> Types:
    """Parameters by type, whatever the kind: what a property deep in a material may be."""
    out: dict[str, str] = {}
    for kind, types in table().items():
        if kind not in ("plot", "log"):
            for name, row in types.rows.items():
                out[name] = f"{out[name]} {row}" if name in out else row
    return Types(out)

"""febkit.Model: built, edited, copied, written; what is wrong is said at once."""

from __future__ import annotations

from inspect import signature
from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit import materials as mt
from febkit.model import InputError
from febkit.modelling import meshes

EXAMPLE = Path(__file__).parents[2] / "examples" / "unconfined_compression.feb"


def plug() -> febkit.Model:
    """A quarter of a plug between platens, drained at its side: no XML in sight."""
    m = febkit.Model("biphasic", units="mm-N-s")
    m.add_cylinder("plug", radius=2.0, height=1.0, n=(4, 3), sector="quarter")
    m.materials["cartilage"] = mt.Biphasic(
        solid=mt.NeoHookean(E=0.6, v=0.1), permeability=mt.PermConstIso(perm=2e-3), phi0=0.2)
    m.fix(m.nodes(x=0.0), "x")
    m.fix(m.nodes(y=0.0), "y")
    m.fix(m.nodes(z="min"), "z")
    m.fix(m.nodes(where=lambda X: np.hypot(X[:, 0], X[:, 1]) > 1.999), "p")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.05, curve=[(0, 0), (1, 1)])
    m.step(time=10.0, dt=0.1, dtmax=2.0, must_points=[1, 10])
    return m


def test_a_plug_is_built_solved_and_written(tmp_path: Path) -> None:
    m = plug()
    assert m.validate() == []
    result = m.solve()
    assert result.converged
    top = m.node_sets["top"]
    assert np.allclose(result.state.u[top.index, 2], -0.05)
    m.write(tmp_path / "plug.feb")
    again = febkit.read(tmp_path / "plug.feb")
    assert again == m
    # the file's own numbers, read and solved anew, to the last bit
    assert np.array_equal(febkit.solve(again).state.d, result.state.d)


def test_it_agrees_with_theory_at_equilibrium() -> None:
    """Confined and drained for long: p = 0 and the stress of uniaxial strain, H' = lambda ln J / J + mu (J - 1 / J)."""
    m = febkit.Model("biphasic")
    m.add_block("column", (1, 1, 1), (1, 1, 4))
    E, v, strain = 0.6, 0.1, 0.1
    m.materials["c"] = mt.Biphasic(solid=mt.NeoHookean(E=E, v=v), permeability=mt.PermConstIso(perm=1.0), phi0=0.2)
    m.fix("all", "x", "y")
    m.fix(m.nodes(z="min"), "z")
    m.fix(m.nodes(z="max"), "p")
    m.prescribe(m.nodes(z="max"), z=-strain, curve=[(0, 0), (1, 1)])
    m.step(time=100, dt=1, dtmax=20)
    result = m.solve()
    J, mu, lam = 1 - strain, E / 2 / (1 + v), E * v / (1 + v) / (1 - 2 * v)
    stress = mu / J * (J * J - 1) + lam * np.log(J) / J
    top = m.nodes(z="max").index
    assert result.state.reaction[top, 2].sum() == pytest.approx(stress, rel=1e-6)


def test_a_solve_leaves_no_file_and_gives_the_dataset_of_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    m = plug()
    result = m.solve()
    assert list(tmp_path.iterdir()) == [] and bool(result) and repr(result).startswith("solved to t = 10")
    on_disk = m.solve("plug.xplt").dataset
    for name in on_disk.data_vars:
        assert np.array_equal(result.dataset[name].values, on_disk[name].values, equal_nan=True), name
    assert result.dataset["effective_fluid_pressure"].sel(time=10.0).notnull().any()
    some = m.solve(variables=["displacement"], at=[0.35, 2.2, 10.0]).dataset
    assert np.allclose(some["time"].values, [0.35, 2.2, 10.0]) and "stress" not in some
    assert [s.control.plot_level for s in m.steps] == ["PLOT_MUST_POINTS"]  # the model itself is as it was
    with pytest.raises(InputError, match='no plot variable "strss"'):
        m.solve(variables=["strss"])


def test_a_run_that_stops_says_why_and_keeps_what_was_solved() -> None:
    m = febkit.Model()
    m.add_block("a", (1, 1, 1), (2, 2, 2))
    m.materials["m"] = mt.NeoHookean(E=1, v=0.3)
    m.fix(m.nodes(z="min"), "x", "y", "z")
    m.prescribe(m.nodes(z="max"), z=-0.6, x=0.4, curve=[(0, 0), (0.5, 1e-4), (1, 1)])
    m.step(time=1.0, dt=0.5, fixed=True, solver={"max_refs": 1, "dtol": 1e-6})
    result = m.solve()
    assert not result and "reformations (1)" in result.reason and repr(result).startswith("stopped")
    assert result.dataset["time"].values[-1] == 0.5


# ---- editing --------------------------------------------------------------------------------------


def test_one_parameter_changes_one_line_of_the_file(tmp_path: Path) -> None:
    m = febkit.read(EXAMPLE)
    name = next(iter(m.materials))
    old = m.materials[name].solid.E
    m.materials[name].solid.E = 2 * old
    m.write(tmp_path / "m.feb")
    before, after = EXAMPLE.read_text().splitlines(), (tmp_path / "m.feb").read_text().splitlines()
    assert len(before) == len(after) and sum(a != b for a, b in zip(before, after)) == 1
    assert 2 * old == febkit.read(tmp_path / "m.feb").materials[name].solid.E


def test_what_is_not_touched_is_written_byte_for_byte(tmp_path: Path) -> None:
    m = febkit.read(EXAMPLE)
    m.write(tmp_path / "m.feb")
    assert (tmp_path / "m.feb").read_bytes() == EXAMPLE.read_bytes()


def test_febio_s_paths_reach_the_same_parameters() -> None:
    m = plug()
    assert m["fem.material('cartilage').solid.E"] == 0.6
    m["fem.material[0].solid.E"] = 0.9
    assert m.materials["cartilage"].solid.E == 0.9
    m["fem.bc[4].value"] = -0.07
    assert m.boundary[4].value == -0.07
    assert m["material('cartilage').permeability.perm"] == 2e-3
    for path, said in (("fem.material('bone').solid.E", 'no material "bone"; there are cartilage'),
                       ("fem.material('cartilage').fluid.E", "no parameter 'fluid'"), ("E", "no parameter path"),
                       ("fem.load[0].pressure", "has no load 0")):
        with pytest.raises(InputError, match=said):
            _ = m[path]


def test_paths_reach_variables_curves_and_one_number_of_several() -> None:
    m = plug()
    m._put(variables={"a": 2.0})
    m.materials["net"] = mt.of("ellipsoidal fiber distribution", ksi=(1, 2, 3), beta=(2, 3, 4))
    m.prescribe("top", p="fem.a*t")
    for path, old, new in (("fem.a", 2.0, 3.0), ("net.ksi[1]", 2, 7.0), ("net.beta.z", 4, 5.0),
                           ("fem.load_controller[0].points[1].y", 1.0, 0.5)):
        assert m[path] == old, path
        m[path] = new
        assert m[path] == new, path
    assert m.materials["net"].ksi == (1, 7, 3) and m.curves[1].points[1][1] == 0.5 and m.record.variables["a"] == 3.0
    for path, said in (("fem.b", 'no global variable "b"; there are a'), ("net.ksi[3]", "there is no number 3"),
                       ("fem.load_controller[7].points[0].y", "no load_controller"),
                       ("cartilage.phi0.y", "there is no number 1"),
                       ("fem.load_controller[0].points[9].y", "there are 2 points")):
        with pytest.raises(InputError, match=said):
            _ = m[path]


def test_names_values_and_ranges_are_checked_when_they_are_set() -> None:
    m = plug()
    with pytest.raises(AttributeError, match=r"biphasic\.solid has no parameter 'Young'; there are E, density, v"):
        m.materials["cartilage"].solid.Young = 1
    with pytest.raises(InputError, match="E must be a finite number, not nan"):
        m.materials["cartilage"].solid.E = float("nan")
    for value in (-1, "-1", 0):
        with pytest.raises(InputError, match=r"solid\.E must be more than 0, not (-1|0)"):
            m.materials["cartilage"].solid.E = value
    with pytest.raises(InputError, match=r"v must be in \[-1, 0.5\), not 0.5"):
        mt.NeoHookean(E=1, v=0.5)
    with pytest.raises(InputError, match=r"Control\.step_size must be at least 0, not -1"):
        m.steps[0].control.step_size = -1
    with pytest.raises(InputError, match=r"solver\.rtol must be at least 0, not -1"):
        m.steps[0].control.solver.rtol = -1
    assert m.materials["cartilage"].solid.E == 0.6
    m.materials["cartilage"].solid.E = "-1 + 2*X"  # FEBio looks at numbers alone
    m.materials["cartilage"].solid["E"].map = "stiffness"
    with pytest.raises(InputError, match="has no parameter 'vv'; did you mean v"):
        mt.NeoHookean(E=1, vv=0.3)
    with pytest.raises(AttributeError, match="did you mean NeoHookean"):
        _ = mt.NeoHookian
    with pytest.raises(InputError, match='no degree of freedom "zz"'):
        m.prescribe("top", zz=1)
    with pytest.raises(InputError, match='no node set or surface "tip"; did you mean "top"'):
        m.fix("tip", "x")
    with pytest.raises(KeyError, match='no part "plugg"; did you mean "plug"'):
        _ = m.parts["plugg"]


def test_a_copy_leaves_the_original_alone() -> None:
    m = plug()
    other = m.copy()
    other.materials["cartilage"].solid.E = 5.0
    other.node_sets["top"] = [int(m.mesh.node_ids[0])]
    assert m.materials["cartilage"].solid.E == 0.6 and len(m.node_sets["top"]) > 1
    assert m != other and m == m.copy()
    assert any("E" in str(d) for d in m.differences(other))


def test_formulas_maps_and_curves_of_a_parameter() -> None:
    m = plug()
    solid = m.materials["cartilage"].solid
    solid.E = "0.5 + 0.1*Z"
    assert solid["E"].formula == "0.5 + 0.1*Z" and m.record.materials[0].need("solid").need("E").type == "math"
    with pytest.raises(InputError, match="formula"):
        solid.E = "0.5 +"
    solid.E = 0.6
    assert solid["E"].formula is None and solid.E == 0.6
    solid["E"].curve = m.curves.add([(0, 1), (10, 2)])
    solid.E = 0.7  # a new value keeps the curve
    assert m.record.materials[0].need("solid").need("E").lc == solid["E"].curve is not None
    solid["E"].curve = None
    assert solid["E"].curve is None
    assert solid.density is None


def test_properties_that_come_several_times() -> None:
    mix = mt.SolidMixture(solid=[mt.NeoHookean(E=1, v=0.3), mt.HolmesMow(E=1, v=0.3, beta=0.5)])
    assert [s.type for s in mix.all("solid")] == ["neo-Hookean", "Holmes-Mow"]
    mix.all("solid")[1].beta = 0.7
    assert mix.all("solid")[1].beta == 0.7
    del mix["solid"]
    assert len(mix.all("solid")) == 0


def test_curves_are_shared_and_may_be_exchanged() -> None:
    m = plug()
    n = len(m.curves)
    k = m.curves.add([(0, 0), (1, 1)])
    assert len(m.curves) == n  # the ramp that is there already
    m.curves[k] = np.array([[0, 0], [2, 1], [3, 1]])
    assert m.curves[k].points == ((0, 0), (2, 1), (3, 1))
    pandas = pytest.importorskip("pandas")
    assert m.curves.add(pandas.Series([0.0, 2.0], index=[0.0, 5.0])) == max(m.curves)
    with pytest.raises(InputError, match="finite and rise"):
        m.curves.add([(1, 0), (0, 1)])
    with pytest.raises(InputError, match="no load curve 99"):
        m.prescribe("top", z=1, curve=99)


# ---- meshes and selections -----------------------------------------------------------------------


@pytest.mark.parametrize("n", [(1, 1), (2, 1), (4, 3), (5, 2)])
@pytest.mark.parametrize("sector", ["full", "quarter"])
def test_cylinders_are_sound_and_fill_the_circle(n: tuple[int, int], sector: str) -> None:
    from febkit.solver import elements

    X, conn = meshes.cylinder(2.0, 3.0, n, sector)
    e = elements.get("hex8")
    J = np.linalg.det(np.einsum("eni,gnj->egij", X[conn], e.dN))
    assert J.min() > 0.05 * J.mean()
    assert len(np.unique(np.round(X, 9), axis=0)) == len(X)
    share = 1.0 if sector == "full" else 0.25
    assert (J @ e.weights).sum() < share * np.pi * 12.0
    if n[0] > 3:
        assert (J @ e.weights).sum() == pytest.approx(share * np.pi * 12.0, rel=0.05)


def test_biased_blocks_grow() -> None:
    X, conn = meshes.block((1, 1, 7), (1, 1, 3), bias=(1, 1, 2))
    assert np.allclose(np.unique(X[:, 2]), [0, 1, 3, 7]) and len(conn) == 3


def test_rules_pick_what_they_say() -> None:
    m = febkit.Model()
    m.add_block("a", (2, 2, 2), (2, 2, 2))
    assert len(m.nodes(z="max")) == 9 and len(m.nodes(z=(0.5, None))) == 18
    assert len(m.nodes(x="min") & m.nodes(z="max")) == 3 and len(~m.nodes(x="min")) == 18
    assert len(m.nodes(plane=((1, 1, 1), (1, 1, 0)))) == 9
    assert len(m.nodes(box=((0, 0, 0), (1, 1, 1)))) == 8 and len(m.nodes(sphere=((0, 0, 0), 1.0))) == 4
    assert len(m.faces(normal=(0, 0, 1))) == 4 and len(m.faces()) == 24
    assert len(m.faces(z="max") | m.faces(z="min")) == 8
    assert len(m.elements(z=(None, 1.0))) == 4
    m.surfaces["top"] = m.faces(z="max")
    assert len(m.surfaces["top"].nodes) == 9
    m.element_sets["low"] = m.elements(z=(None, 1.0))
    with pytest.raises(InputError, match="element 99"):
        m.element_sets["low"] = [1, 99]
    with pytest.raises(InputError, match="node 99 is not"):
        m.node_sets["n"] = [1, 99]
    with pytest.raises(InputError, match='z = \'top\''):
        m.nodes(z="top")


def test_a_gmsh_mesh_brings_its_groups() -> None:
    meshio = pytest.importorskip("meshio")
    X, conn = meshes.block((1, 1, 1), (1, 1, 1))
    mesh = meshio.Mesh(X, [("hexahedron", conn), ("quad", np.array([[4, 5, 7, 6]]))],
                       cell_data={"gmsh:physical": [np.array([1]), np.array([2])]},
                       field_data={"bone": np.array([1, 3]), "top": np.array([2, 2])})
    m = febkit.Model.from_meshio(mesh, "solid", units="SI")
    assert list(m.parts) == ["bone"] and list(m.surfaces) == ["top"] and m.units == "SI"
    m.materials["b"] = mt.NeoHookean(E=1, v=0.3)
    assert m.parts["bone"].material == "b"


# ---- loads, contact, rigid bodies, steps ---------------------------------------------------------


def test_a_pressure_on_a_face_by_its_normal() -> None:
    m = febkit.Model()
    m.add_block("a", (1, 1, 1), (1, 1, 1))
    m.materials["m"] = mt.IsotropicElastic(E=1.0, v=0.0)
    m.fix(m.nodes(z="min"), "z")
    m.fix(m.nodes(x="min"), "x")
    m.fix(m.nodes(y="min"), "y")
    m.load(m.faces(normal=(0, 0, 1)), "pressure", pressure=0.001, curve=[(0, 0), (1, 1)])
    m.step(time=1.0, dt=0.5)
    u = m.solve().state.u
    assert u[m.nodes(z="max").index, 2] == pytest.approx(-0.001, rel=5e-3)
    with pytest.raises(InputError, match='no load "pressur"; did you mean "pressure"'):
        m.load(m.faces(z="max"), "pressur")


def test_a_rigid_platen_in_two_steps() -> None:
    m = febkit.Model()
    m.add_block("soft", (1, 1, 1), (2, 2, 2))
    m.add_block("platen", (1, 1, 0.1), (2, 2, 1), origin=(0, 0, 1))
    m.materials["soft"] = mt.NeoHookean(E=1, v=0.2)
    m.materials["lid"] = mt.RigidBody(density=1, center_of_mass=(0.5, 0.5, 1.0))
    m.assign("soft", "soft")
    m.assign("lid", "platen")
    m.fix(m.nodes(z=0.0), "x", "y", "z")
    m.attach(m.nodes(part="soft", z=1.0), "lid")
    m.fix_body("lid", "Rx", "Ry", "Ru", "Rv", "Rw")
    first = m.step("press", time=1, dt=0.5)
    first.move_body("lid", z=-0.1, curve=[(0, 0), (1, 1)])
    second = m.step("lift", time=1, dt=0.5)
    second.move_body("lid", z=-0.05)
    assert len(m.steps) == 2 and m.steps["lift"].control.analysis == "STATIC"
    result = m.solve()
    assert result.converged
    top = m.nodes(part="soft", z=1.0).index
    assert np.allclose(result.state.u[top, 2], -0.05)
    second.control.solver.dtol = 1e-5
    assert m.record.steps[1].control.need("solver").float("dtol") == 1e-5
    with pytest.raises(InputError, match="say which"):
        _ = m.control


def test_contact_of_two_blocks() -> None:
    m = febkit.Model()
    m.add_block("low", (1, 1, 1), (2, 2, 2))
    m.add_block("high", (1, 1, 1), (2, 2, 2), origin=(0, 0, 1))
    m.materials["m"] = mt.NeoHookean(E=1, v=0.0)
    m.fix(m.nodes(z=0.0), "x", "y", "z")
    m.touch(m.faces(part="high", z=1.0, normal=(0, 0, -1)), m.faces(part="low", z=1.0, normal=(0, 0, 1)),
            "tied-elastic", penalty=1e3)
    m.fix(m.nodes(z=2.0), "x", "y")
    m.prescribe(m.nodes(z=2.0), z=-0.2, curve=[(0, 0), (1, 1)])
    m.step(time=1, dt=0.2)
    result = m.solve()
    assert result.converged
    middle = m.nodes(part="low", z=1.0).index
    assert result.state.u[middle, 2] == pytest.approx(-0.1, abs=2e-3)


# ---- looks ----------------------------------------------------------------------------------------


def test_it_says_what_it_is() -> None:
    m = plug()
    assert "part plug" in repr(m) and "material cartilage: biphasic" in repr(m)
    assert m._repr_html_().startswith("<pre>")
    assert "E = 0.6" in repr(m.materials["cartilage"])
    assert repr(m.steps[0]).startswith("step 1: transient, 100 steps of 0.1")
    assert "displacement" in repr(m.output) and "top" in repr(m.node_sets)


def test_tab_finds_everything() -> None:
    m = plug()
    assert {"NeoHookean", "HolmesMow", "PermConstIso", "Biphasic", "RigidBody"} <= set(dir(mt))
    assert {"E", "v", "density"} <= set(dir(m.materials["cartilage"].solid))
    assert {"Model", "materials", "read", "solve"} <= set(dir(febkit))
    import inspect

    assert list(inspect.signature(mt.HolmesMow).parameters)[:3] == ["E", "v", "beta"]
    assert "Holmes" in (mt.HolmesMow.__doc__ or "")


def test_every_solver_material_has_a_constructor() -> None:
    from febkit.solver.solids.registry import tables

    types = set(mt.names().values())
    assert {t for kinds in tables().values() for t in kinds} <= types
    for name in mt.names():
        assert name.isidentifier()


# ---- solutes --------------------------------------------------------------------------------------


def charged() -> febkit.Model:
    """A block of charged tissue, its salt and a molecule bound to it."""
    m = febkit.Model("multiphasic", units="mm-N-s")
    m.set_constants(R=8.314e-6, T=298.0, Fc=9.65e-5)
    m.solute("Na+", charge=1)
    m.solute("Cl-", charge=-1)
    m.solid_bound("CS", charge=-2, molar_mass=4e-7, density=1.5e-3)
    m.add_block("tissue", (1, 1, 1), (1, 1, 2))
    ions = [
        mt.Solute(n, diffusivity=mt.DiffConstIso(free_diff=d, diff=0.5 * d), solubility=mt.SolubConst(solub=1.0))
        for n, d in (("Na+", 1.3e-3), ("Cl-", 2.0e-3))
    ]
    m.materials["tissue"] = mt.Multiphasic(
        phi0=0.2, solid=mt.NeoHookean(E=0.5, v=0.1), permeability=mt.PermConstIso(perm=1e-3),
        osmotic_coefficient=mt.OsmCoefConst(osmcoef=1.0), fixed_charge_density=-100.0, solute=ions,
        solid_bound=mt.SolidBound("CS", rho0=1e-5),
        reaction=mt.ConcentrationIndependent(
            vP={"CS": 1, "Na+": 2}, Vbar=0.0, override_vbar=True, forward_rate=mt.ConstantReactionRate(k=0.01)))
    m.fix("all", "x", "y", "z")
    m.initial(**{"Na+": 150.0, "Cl-": 150.0})
    m.prescribe(m.nodes(z="max"), p=-0.743, **{"Na+": 150.0, "Cl-": 150.0})
    m.step(time=10.0, dt=5.0)
    return m


def test_solutes_are_declared_once_and_named_afterwards(tmp_path: Path) -> None:
    m = charged()
    assert [(s.name, s.id, s.charge) for s in m.solutes] == [("Na+", 1, 1), ("Cl-", 2, -1)]
    assert m.solid_bound_molecules[0].molar_mass == 4e-7
    assert not [f for f in m.validate() if f.severity == "error"]
    assert [c["dof"].value for c in (m.boundary[2], m.boundary[3])] == ["c1", "c2"]
    m.write(tmp_path / "m.feb")
    again = febkit.read(tmp_path / "m.feb")
    assert again == m
    again.solute("Glc")  # a file's own list grows
    again.write(tmp_path / "longer.feb")
    longer = febkit.read(tmp_path / "longer.feb")
    assert [s.name for s in longer.solutes] == ["Na+", "Cl-", "Glc"] and len(longer.solid_bound_molecules) == 1
    ds = m.solve().dataset
    assert list(ds["solute"].values) == ["Na+", "Cl-"]
    inside = ds["solute_concentration"].isel(time=-1)
    assert (inside.sel(solute="Na+") > inside.sel(solute="Cl-") + 50).all()


def test_mixtures_are_solved_by_broyden_s_updates_where_nothing_else_is_said() -> None:
    m = charged()
    assert m.control.solver.qn_method.type == "Broyden"
    m.step(time=1.0, solver={"qn_method": mt.of("BFGS")})
    assert m.steps[1].control.solver.qn_method.type == "BFGS"
    assert "qn_method" not in plug().control.solver


def test_every_solute_has_a_condition_of_its_own() -> None:
    """FEBio's zero concentration takes one solute."""
    m = charged()
    made = m.fix(m.nodes(z="min"), "Cl-", "c1", "p")
    zero = "zero concentration"
    assert [(c.type, c["c_dof"].value) for c in made[:2]] == [(zero, "c2"), (zero, "c1")]
    assert made[2].type == "zero fluid pressure"
    flux = m.load(m.faces(z="min"), "soluteflux", solute_id="Cl-", flux=0.1, linear=True)
    assert flux.solute_id == 2
    assert m.solve().converged


def test_what_is_wrong_with_a_solute_is_said() -> None:
    m = charged()
    for bad, said in ((lambda: m.solute("Na+"), "has a species 'Na\\+' already"),
                      (lambda: m.solute("K+", 0.5), "charge number is a whole number, not 0.5"),  # type: ignore[arg-type]
                      (lambda: m.solid_bound("HA", density=0.0), "density must be more than 0"),
                      (lambda: m.prescribe("all", K=1.0), 'no degree of freedom "K"'),
                      (lambda: m.load(m.faces(z="min"), "soluteflux", solute_id="K+"), 'no solute "K\\+"')):
        with pytest.raises(InputError, match=said):
            bad()
    m.materials["tissue"].add("solute", mt.Solute(
        "Cl", diffusivity=mt.DiffConstIso(), solubility=mt.SolubConst()))
    with pytest.raises(InputError, match='there is no solute "Cl" in <Globals>'):
        m.solve()


def test_parameters_of_a_solute_are_checked_and_found() -> None:
    m = charged()
    sodium, chloride = m.materials["tissue"].all("solute")
    chloride.diffusivity.diff = 5e-4
    assert sodium.diffusivity.diff == 6.5e-4 and m.materials["tissue"].all("solute")[1].diffusivity.diff == 5e-4
    with pytest.raises(AttributeError, match="no parameter 'dif'; did you mean diff"):
        sodium.diffusivity.dif = 1.0
    assert "free_diff=1.0" in str(signature(mt.DiffConstIso))
    # properties of several parameters, by their constructors: each is known
    assert mt.OsmCoefManning(osmc=1.0, ksi=2.0, co_ion="Cl-").co_ion == "Cl-"


def test_every_constructor_can_be_called() -> None:
    """Laws that are parts of materials as well: fiber distributions, relaxations, damage, growth, prestrain."""
    for name, kind in mt.names().items():
        assert f'"{kind}"' in (mt.constructor(name).__doc__ or "")
        assert mt.constructor(name)().component.type == kind
    assert mt.PrestrainGradient().ramp == 1.0
    assert signature(mt.VolumeGrowth).parameters["multiplier"].default == 1.0


def test_shells_have_a_thickness(tmp_path: Path) -> None:
    m = febkit.Model()
    m.add_part("plate", "quad4", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    m.add_block("cube", (1, 1, 1), (1, 1, 1), origin=(2, 0, 0))
    assert m.parts["plate"].thickness is None
    m.parts["plate"].thickness = 0.1
    m.materials["steel"] = mt.NeoHookean(E=1, v=0.3)
    m.parts["plate"].thickness = 0.2
    m.write(tmp_path / "m.feb")
    again = febkit.read(tmp_path / "m.feb").parts["plate"]
    assert again.thickness == 0.2 and again.material == "steel"
    with pytest.raises(InputError, match='part "cube" holds hex8, which have no thickness'):
        m.parts["cube"].thickness = 1
    for wrong in (0, -1, "thick"):
        with pytest.raises(InputError, match="the thickness of shells must be more than 0, not"):
            m.parts["plate"].thickness = wrong

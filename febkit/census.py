"""What febkit does with each type that FEBio registers: a small model that has it is put to the solver's reader.

Everything is read, converted and written; what is not solved is refused by name. So the answers are those of a run,
and a material or a load that is added is found by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from importlib import import_module
from xml.sax.saxutils import escape

from febkit.feb.modules import module, registered
from febkit.feb.read import read_bytes
from febkit.model import InputError, elements

# materials whose parameters are whole, by module
USUAL = {
    "solid": '<material id="1" name="m" type="neo-Hookean"><density>1</density><E>1</E><v>0</v></material>',
    "biphasic": '<material id="1" name="m" type="biphasic"><phi0>0.2</phi0><solid type="neo-Hookean"><E>1</E><v>0</v>'
    '</solid><permeability type="perm-const-iso"><perm>1</perm></permeability></material>',
    "multiphasic": '<material id="1" name="m" type="biphasic-solute"><phi0>0.2</phi0><solid type="neo-Hookean"><E>1</E>'
    '<v>0</v></solid><permeability type="perm-const-iso"><perm>1</perm></permeability><osmotic_coefficient '
    'type="osm-coef-const"><osmcoef>1</osmcoef></osmotic_coefficient><solute sol="1"><diffusivity '
    'type="diff-const-iso"><free_diff>1</free_diff><diff>1</diff></diffusivity><solubility type="solub-const">'
    "<solub>1</solub></solubility></solute></material>",
}
MULTIPHASIC = USUAL["multiphasic"].replace("biphasic-solute", "multiphasic")
MODEL = """<febio_spec version="4.0"><Module type="{module}"/>
<Globals><Constants><R>8.3e-6</R><T>298</T><Fc>96.5</Fc></Constants>
<Solutes><solute id="1" name="s"><charge_number>0</charge_number></solute></Solutes></Globals>
<Material>{material}{more}</Material>
<Mesh><Nodes name="all">{points}</Nodes>
<Elements type="{element}" name="p"><elem id="1">{nodes}</elem></Elements>
<NodeSet name="n">1,2,3,4</NodeSet><Surface name="s"><quad4 id="1">1,4,3,2</quad4></Surface>
<Surface name="t"><quad4 id="1">5,6,7,8</quad4></Surface><Edge name="e"><line2 id="1">1,2</line2></Edge>
<SurfacePair name="pair"><primary>s</primary><secondary>t</secondary></SurfacePair>
<DiscreteSet name="d"><delem>1,5</delem></DiscreteSet></Mesh>
<MeshDomains><{kind}Domain name="p" mat="m"{domain}/></MeshDomains>
<Step><step id="1"><Control><analysis>{analysis}</analysis><time_steps>1</time_steps><step_size>1</step_size>
{control}</Control></step></Step>{sections}</febio_spec>"""
# corners of a cube, then points for elements with more nodes
CORNERS = ("0,0,0", "1,0,0", "1,1,0", "0,1,0", "0,0,1", "1,0,1", "1,1,1", "0,1,1")
POINTS = "".join(f'<node id="{k}">{x}</node>' for k, x in enumerate((*CORNERS, *(f"0,0,{k}" for k in range(9, 28))), 1))
SHELL, SOLID = ("quad4", "1,2,3,4"), ("hex8", "1,2,3,4,5,6,7,8")
BEAM = ("line2", "1,2")
# where a type stands: kind, and pieces of the model, several where it may stand in several places
SECTIONS = {
    "boundary condition": ('<Boundary><bc type="{}" node_set="n"/></Boundary>',
                           '<Boundary><bc type="{}" surface="s"/></Boundary>', '<Rigid><rigid_bc type="{}"/></Rigid>'),
    "initial condition": ('<Initial><ic type="{}" node_set="n"/></Initial>', '<Rigid><rigid_ic type="{}"/></Rigid>'),
    "load": ('<Loads><surface_load type="{}" surface="s"/></Loads>',
             '<Loads><nodal_load type="{}" node_set="n"/></Loads>', '<Loads><body_load type="{}"/></Loads>',
             '<Rigid><rigid_load type="{}"/></Rigid>'),
    "contact": ('<Contact><contact type="{}" surface_pair="pair"/></Contact>',),
    "constraint": ('<Constraints><constraint type="{}" surface="s" node_set="n"/></Constraints>',
                   '<Rigid><rigid_connector type="{}" name="c"/></Rigid>'),
    "mesh adaptor": ('<MeshAdaptor><mesh_adaptor type="{}"/></MeshAdaptor>',),
    "adaptor criterion": ('<MeshAdaptor><mesh_adaptor type="erosion"><criterion type="{}"/></mesh_adaptor>'
                          '</MeshAdaptor>',),
    "load controller": ('<Boundary><bc type="prescribed displacement" node_set="n"><dof>x</dof>'
                        '<value lc="1">1</value></bc></Boundary>'
                        '<LoadData><load_controller id="1" type="{}"/></LoadData>',),
    "discrete material": ('<Discrete><discrete_material id="1" name="k" type="{}"/>'
                          '<discrete dmat="1" discrete_set="d"/></Discrete>',),
    "data generator": ('<Loads><body_load type="const"><x type="map">v</x></body_load></Loads>'
                       '<MeshData><ElementData name="v" elem_set="p" type="{}"/></MeshData>',
                       '<Loads><surface_load type="pressure" surface="s"><pressure type="map">v</pressure>'
                       '</surface_load></Loads><MeshData><SurfaceData name="v" surface="s" type="{}"/></MeshData>',
                       '<Boundary><bc type="prescribed displacement" node_set="n"><dof>x</dof><value type="map">v'
                       '</value></bc></Boundary><MeshData><NodeData name="v" node_set="n" type="{}"><math>X</math>'
                       '</NodeData></MeshData>'),
    "function": ('<Discrete><discrete_material id="1" name="k" type="nonlinear spring"><force type="{}"/>'
                 '</discrete_material><discrete dmat="1" discrete_set="d"/></Discrete>',),
    "value": ('<Loads><surface_load type="pressure" surface="s"><pressure type="{}"/></surface_load></Loads>',),
}  # fmt: skip
# properties of materials
MATERIALS = {
    "active momentum supply": USUAL["biphasic"].replace("</material>", '<active_supply type="{}"/></material>'),
    "membrane reaction": MULTIPHASIC.replace("</material>", '<membrane_reaction type="{}"/></material>'),
    "membrane reaction rate": MULTIPHASIC.replace(
        "</material>", '<membrane_reaction type="membrane-mass-action-forward"><forward_rate type="{}"/>'
        "</membrane_reaction></material>"),
}  # fmt: skip
FIBERS = '<material id="1" name="m" type="fiber-NH"><mu>1</mu><fiber type="map">v</fiber></material>'
MAPPED = '<material id="1" name="m" type="neo-Hookean"><E type="map">v</E><v>0</v></material>'
ALONG = ('<MeshData><ElementData name="v" elem_set="p" type="{}"><surface1>s</surface1><surface2>t</surface2>'
         '</ElementData></MeshData>')  # fmt: skip
REMODELED = ('<material id="1" name="m" type="remodeling solid"><solid type="{}"/><supply type="Huiskes-supply">'
             '<B>1</B><k>1</k></supply></material>')
FACET = '<Loads><surface_load type="pressure" surface="f"/></Loads>'
# within <Control>
CONTROL = {
    "solver": ('<solver type="{}"/>',), "control tag": ("<{0}>1</{0}>",),
    "solver tag": ("<solver><{0}>0</{0}></solver>", '<solver type="explicit-solid"><{0}>1</{0}></solver>',
                   '<solver type="CG-solid"><{0}>1</{0}></solver>'),
    "quasi-Newton method": ('<solver><qn_method type="{}"/></solver>',),
    "linear solver": ('<solver><linear_solver type="{}"/></solver>',),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Entry:
    """A type of FEBio's and whether febkit solves with it."""

    kind: str
    name: str
    solved: bool


def census(kinds: tuple[str, ...] = ()) -> Iterator[Entry]:
    """Every type of FEBio's modules of solids and mixtures, of these kinds (all where none is named), in order."""
    for kind, names in everything().items():
        if not kinds or kind in kinds:
            yield from (Entry(kind, n, solves(kind, n)) for n in names)


def everything() -> dict[str, tuple[str, ...]]:
    """Types by kind: those of FEBio's registrations, and its elements."""
    return {"element": tuple(e.name for e in elements.ELEMENTS.values()), **registered()}


def solves(kind: str, name: str) -> bool:
    """Does the solver's reader take a type of this kind?"""
    if kind in TABLES:
        return name in TABLES[kind]()
    return any(map(_accepted, _models(kind, name)))


def _models(kind: str, name: str) -> Iterator[str]:
    """Small models that have a type of a kind, one for each place where it may stand."""
    of = module(name)
    fields = {"points": POINTS, "module": of, "material": USUAL[of], "more": "", "kind": "Solid", "element": SOLID[0],
              "nodes": SOLID[1], "domain": "", "control": "", "sections": "",
              "analysis": "static" if of == "solid" else "transient"}  # fmt: skip
    said = escape(name, {'"': "&quot;"})
    if kind in SECTIONS:
        yield from (MODEL.format(**fields | {"sections": s.format(said)}) for s in SECTIONS[kind])
        if kind == "data generator":
            yield MODEL.format(**fields | {"material": FIBERS, "sections": ALONG.format(said)})
            yield MODEL.format(**fields | {"material": MAPPED, "sections": ALONG.format(said)})
    elif kind in MATERIALS:
        of = next((m for m, known in USUAL.items() if f'type="{m}"' in MATERIALS[kind] and known), "solid")
        yield MODEL.format(**fields | {"module": of, "material": MATERIALS[kind].format(said)})
    elif kind in CONTROL:
        yield from (MODEL.format(**fields | {"control": s.format(said)}) for s in CONTROL[kind])
    elif kind == "material":
        material = f'<material id="1" name="m" type="{said}"/>'
        beam = any(w in name for w in ("beam", "truss", "spring"))
        element, nodes = BEAM if beam else SOLID
        own = ' type="linear-beam"' if name == "linear-beam" else ""
        yield MODEL.format(**fields | {"material": material, "element": element, "nodes": nodes, "domain": own,
                                       "kind": "Beam" if beam else "Solid"})  # fmt: skip
        yield MODEL.format(**fields | {"material": REMODELED.format(said)})
    elif kind == "domain":
        if name.startswith("rigid"):
            fields["material"] = '<material id="1" name="m" type="rigid body"/>'
        for which, (element, nodes) in (("Solid", SOLID), ("Shell", SHELL), ("Beam", BEAM)):
            more = "<shell_thickness>1</shell_thickness>" if which == "Shell" else ""
            text = MODEL.format(**fields | {"kind": which, "element": element, "nodes": nodes,
                                            "domain": f' type="{said}"'})  # fmt: skip
            yield text.replace(f' type="{said}"/>', f' type="{said}">{more}</{which}Domain>') if more else text
    elif kind == "element":
        e = elements.ELEMENTS[name]
        which = {3: "Solid", 2: "Shell", 1: "Beam"}[e.dim]
        if e.dim == 1:
            line = "linear-beam" if e.nodes > 2 else "linear truss"
            fields["material"] = f'<material id="1" name="m" type="{line}"/>'
            fields["domain"] = ' type="linear-beam"' if e.nodes > 2 else ""
        nodes = ",".join(map(str, range(1, e.nodes + 1)))
        yield MODEL.format(**fields | {"kind": which, "element": name, "nodes": nodes})
        if e.dim == 2:
            text = MODEL.format(**fields | {"sections": FACET})
            yield text.replace("</Mesh>", f'<Surface name="f"><{name} id="1">{nodes}</{name}></Surface></Mesh>')


def _accepted(text: str) -> bool:
    """Does the solver's reader refuse nothing? What it misses further on in these small models does not count."""
    from febkit.lower import unsupported

    model = read_bytes(text.encode())
    try:
        return not unsupported(model)
    except InputError:
        return True


def _laws(package: str) -> Callable[[], Collection[str]]:
    return lambda: import_module(f"febkit.solver.{package}").TYPES


def _within(table: str) -> Callable[[], Collection[str]]:
    """Properties of solid materials."""

    def names() -> Collection[str]:
        from febkit.solver.solids.registry import tables

        return tables().get(table, ())

    return names


def _plots() -> Collection[str]:
    from febkit.output import plot

    return [n for n in registered()["plot variable"] if plot.find(n) is not None]


def _logs() -> Collection[str]:
    from febkit.output.records.known import known

    return [n for n in registered()["log item"] if known(n)]


# kinds whose types stand in a table of the solver's own
TABLES: dict[str, Callable[[], Collection[str]]] = {
    "permeability": _laws("permeabilities"), "solvent supply": _laws("supplies"), "diffusivity": _laws("diffusivities"),
    "solubility": _laws("solubilities"), "osmotic coefficient": _laws("osmotic_coefficients"),
    "solute supply": _laws("solute_supplies"), "reaction": _laws("reactions"), "reaction rate": _laws("reaction_rates"),
    "active contraction": _within("active"), "bond relaxation": _within("relaxation"),
    "bond recruitment": _within("recruitment"), "damage distribution": _within("cdf"),
    "damage criterion": _within("criterion"), "fiber distribution": _within("distribution"),
    "fiber material": _within("fiber"), "integration scheme": _within("scheme"), "growth tensor": _within("growth"),
    "plastic flow curve": _within("flow_curve"), "prestrain gradient": _within("prestrain"),
    "solid supply": _within("solid_supply"),
    "plot variable": _plots,
    "log item": _logs,
    "optimisation method": lambda: import_module("febkit.fitting.optimise").METHODS,
    "axes": lambda: import_module("febkit.lower.axes").MAT_AXIS,
    "direction": lambda: import_module("febkit.lower.axes").DIRECTION,
    "data record": lambda: import_module("febkit.output.records").KINDS,
}  # fmt: skip

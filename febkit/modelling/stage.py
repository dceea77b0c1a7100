"""Conditions, loads, contact and rigid bodies that act during one step, or in all of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from febkit.feb.dofs import BY_DOF
from febkit.feb.features import table
from febkit.model import Component, InputError, Step, SurfacePair
from febkit.model.species import dof as dof_of

from . import species
from .curves import resolved, scaled
from .node import Node
from .sets import fresh, missing, node_reference, surface_reference
from .text import is_number, written

if TYPE_CHECKING:
    from .model import Model

# the tag of a load by the kind that FEBio registers it under, and the set it acts on
LOADS = {"surface_load": "surface", "nodal_load": "node_set", "body_load": "elem_set"}
# the parameter of a load that a curve multiplies
MAGNITUDE = {
    "pressure": "pressure", "traction": "scale", "force": "force", "fluidflux": "flux", "normal_traction": "traction",
    "nodal_load": "scale", "nodal_force": "value", "body force": "force", "soluteflux": "flux",
    "nodal fluidflux": "value", "rigid_force": "value", "rigid_moment": "value",
}  # fmt: skip


class Components:
    """The conditions (loads, ...) of a step: by place, by name, in turn; ``del`` takes one out."""

    def __init__(self, stage: Stage, field: str) -> None:
        self._stage, self._field = stage, field

    def _held(self) -> tuple[Component, ...]:
        held: tuple[Component, ...] = getattr(self._stage._step(), self._field)
        return held

    def _place(self, key: int | str) -> int:
        held = self._held()
        if isinstance(key, str):
            at = [k for k, c in enumerate(held) if c.name == key]
            if not at:
                raise KeyError(missing(self._field, key, [c.name for c in held if c.name]))
            return at[0]
        return range(len(held))[key]

    def __getitem__(self, key: int | str) -> Node:
        at = self._place(key)

        def put(new: Component) -> None:
            held = self._held()
            self._stage._put_step(**{self._field: (*held[:at], new, *held[at + 1 :])})

        c = self._held()[at]
        return Node(lambda: self._held()[at], put, c.type or c.tag)

    def __delitem__(self, key: int | str) -> None:
        at, held = self._place(key), self._held()
        self._stage._put_step(**{self._field: (*held[:at], *held[at + 1 :])})

    def __len__(self) -> int:
        return len(self._held())

    def __repr__(self) -> str:
        return "\n".join(f"{k}: {c.name or ''} {c.type or c.tag} {' '.join(c.attrs.values())}".replace(":  ", ": ")
                         for k, c in enumerate(self._held())) or "none"  # fmt: skip

    def add(self, c: Component) -> Node:
        self._stage._put_step(**{self._field: (*self._held(), c)})
        return self[len(self) - 1]

    def _ipython_key_completions_(self) -> list[str]:
        return [c.name for c in self._held() if c.name]


class Stage:
    """What acts in a step. On the model itself: in all steps."""

    model: Model

    def _step(self) -> Step:
        raise NotImplementedError

    def _put_step(self, **changes: Any) -> None:
        raise NotImplementedError

    # ---- lists ------------------------------------------------------------------------------------
    @property
    def boundary(self) -> Components:
        """Boundary conditions."""
        return Components(self, "boundary")

    @property
    def loads(self) -> Components:
        """Nodal, surface and body loads."""
        return Components(self, "loads")

    @property
    def contact(self) -> Components:
        """Contact interfaces."""
        return Components(self, "contact")

    @property
    def constraints(self) -> Components:
        """Nonlinear constraints."""
        return Components(self, "constraints")

    @property
    def rigid(self) -> Components:
        """Conditions, loads and connectors of rigid bodies."""
        return Components(self, "rigid")

    @property
    def initial_conditions(self) -> Components:
        """Initial conditions."""
        return Components(self, "initial")

    # ---- conditions on degrees of freedom ---------------------------------------------------------
    def fix(self, where: Any, *dofs: str, name: str | None = None) -> list[Node]:
        """Hold degrees of freedom at zero: ``m.fix("bottom", "x", "y", "z")``, ``m.fix("top", "p")``.

        where: a node set, surface or part by name, or a selection; dofs: x y z, u v w (rotations), sx sy sz (shells),
        p (effective fluid pressure), c1 c2 ... or solutes by name (effective concentrations).
        """
        groups = _grouped(self._dofs(dofs))
        where_ = node_reference(self.model, where)
        made = []
        for own in groups:
            g = BY_DOF[own[0]]
            if g.fixed is None:
                raise InputError(f"{own[0]} cannot be fixed")
            flags = [Component("c_dof", text=own[0])] if own[0][0] == "c" else [
                Component(f"{d}_dof", text="1" if d in own else "0") for d in g.dofs]  # fmt: skip
            parts = tuple(flags) if g.named else ()
            made.append(self.boundary.add(Component("bc", g.fixed, name, None, "", {"node_set": where_}, parts)))
        return made

    def prescribe(
        self, where: Any, *, curve: Any = None, relative: bool = False, name: str | None = None, **dofs: Any
    ) -> list[Node]:
        """Prescribe degrees of freedom: ``m.prescribe("top", z=-0.1, curve=[(0, 0), (1, 1)])``.

        Values are numbers, formulas of X, Y, Z and t, or names of maps as ``{"map": name}``; ``curve`` multiplies
        them: points (t, value), or the id of a curve; without one they act at once. A solute's name stands for its
        effective concentration: ``m.prescribe("bath", **{"Na+": 150})``.
        """
        where_, lc = node_reference(self.model, where), resolved(self.model, curve)
        made = []
        for dof, value in zip(self._dofs(dofs), dofs.values()):
            _ = _grouped((dof,))
            g = BY_DOF[dof]
            if g.prescribed is None:
                raise InputError(f"{dof} cannot be prescribed")
            parts = [Component("dof", text=dof)] if g.named else []
            parts += [scaled(valued("value", value), lc), Component("relative", text="1" if relative else "0")]
            bc = Component("bc", g.prescribed, name, None, "", {"node_set": where_}, tuple(parts))
            made.append(self.boundary.add(bc))
        return made

    def initial(self, where: Any = "all", *, name: str | None = None, **dofs: Any) -> list[Node]:
        """Initial values: ``m.initial(p=0.1, c1=150)``, ``m.initial("ball", velocity=(0, 0, -1))``; solutes by name."""
        where_ = node_reference(self.model, where)
        made = []
        for dof, value in zip(self._dofs(dofs), dofs.values()):
            if dof == "velocity":
                kind, parts = "initial velocity", [Component("value", text=written(value))]
            else:
                _ = _grouped((dof,))
                g = BY_DOF[dof]
                if g.initial is None:
                    raise InputError(f"{dof} has no initial value")
                kind = g.initial
                parts = [Component("dof", text=dof)] if g.named else []
                parts.append(valued("value", value))
            ic = Component("ic", kind, name, None, "", {"node_set": where_}, tuple(parts))
            made.append(self.initial_conditions.add(ic))
        return made

    def _dofs(self, names: Iterable[str]) -> tuple[str, ...]:
        """Degrees of freedom by FEBio's names."""
        return tuple(dof_of(self.model.record, n) for n in names)

    # ---- loads ------------------------------------------------------------------------------------
    def load(self, where: Any, type: str, *, curve: Any = None, name: str | None = None, **parameters: Any) -> Node:
        """A nodal, surface or body load by FEBio's type: ``m.load("top", "pressure", pressure=0.2, curve=...)``.

        where: a surface (or m.faces(...)) for surface loads, a node set or selection for nodal ones, a part or element
        set (None: everything) for body loads. ``curve`` multiplies the load's magnitude. ``solute_id`` may be a name.
        """
        kind = next((k for k in LOADS if type in table()[k]), None)
        if kind is None:
            known = sorted(t for k in LOADS for t in table()[k])
            raise InputError(missing("load", type, known))
        attrs = {}
        if kind == "surface_load":
            attrs["surface"] = surface_reference(self.model, where)
        elif kind == "nodal_load":
            attrs["node_set"] = node_reference(self.model, where)
        elif where is not None:
            attrs["elem_set"] = str(where)
        if isinstance(parameters.get("solute_id"), str):
            parameters["solute_id"] = species.number_of(self.model.record, parameters["solute_id"])
        c = _filled(Component(kind, type, name, None, "", attrs), parameters)
        return self.loads.add(self._driven(c, curve))

    def _driven(self, c: Component, curve: Any) -> Component:
        """A load whose magnitude a curve multiplies."""
        lc = resolved(self.model, curve)
        if lc is None:
            return c
        main = MAGNITUDE.get(c.type or "")
        if main is None:
            raise InputError(f'say which parameter of "{c.type}" the curve multiplies: load["parameter"].curve = ...')
        if c.child(main) is None:
            c = replace(c, children=(*c.children, Component(main, text="1")))
        return replace(c, children=tuple(scaled(x, lc) if x.tag == main else x for x in c.children))

    # ---- contact and rigid bodies -----------------------------------------------------------------
    def touch(self, primary: Any, secondary: Any, type: str = "sliding-elastic", *, name: str | None = None,
              **parameters: Any) -> Node:  # fmt: skip
        """Contact between two surfaces: ``m.touch("indenter", "top", penalty=1, auto_penalty=True)``."""
        if type not in table()["contact"]:
            raise InputError(missing("contact", type, sorted(table()["contact"])))
        one, two = (surface_reference(self.model, s) for s in (primary, secondary))
        mesh = self.model.record.mesh
        pair = next((p.name for p in mesh.surface_pairs.values() if (p.primary, p.secondary) == (one, two)), None)
        if pair is None:
            pair = fresh("contact", mesh.surface_pairs)
            pairs = {**mesh.surface_pairs, pair: SurfacePair(pair, one, two)}
            self.model._put(mesh=replace(mesh, surface_pairs=pairs))
        return self.contact.add(_filled(Component("contact", type, name, None, "", {"surface_pair": pair}), parameters))

    def attach(self, where: Any, body: str, name: str | None = None) -> Node:
        """Nodes that move with a rigid body (the name of its material)."""
        self._body(body)
        attrs = {"node_set": node_reference(self.model, where)}
        return self.boundary.add(Component("bc", "rigid", name, None, "", attrs, (Component("rb", text=body),)))

    def fix_body(self, body: str, *dofs: str, name: str | None = None) -> Node:
        """Hold a rigid body: Rx Ry Rz (its centre), Ru Rv Rw (its rotation)."""
        self._body(body)
        known = ("Rx", "Ry", "Rz", "Ru", "Rv", "Rw")
        for d in dofs:
            if d not in known:
                raise InputError(missing("degree of freedom of a rigid body", d, known))
        flags = tuple(Component(f"{d}_dof", text="1" if d in dofs else "0") for d in known)
        parts = (Component("rb", text=body), *flags)
        return self.rigid.add(Component("rigid_bc", "rigid_fixed", name, children=parts))

    def move_body(self, body: str, *, curve: Any = None, relative: bool = False, name: str | None = None,
                  **dofs: float) -> list[Node]:  # fmt: skip
        """Move a rigid body: x y z (displacement of its centre), Ru Rv Rw (its rotation)."""
        self._body(body)
        lc, made = resolved(self.model, curve), []
        for d, value in dofs.items():
            if d not in ("x", "y", "z", "Ru", "Rv", "Rw"):
                raise InputError(missing("degree of freedom of a rigid body", d, ("x", "y", "z", "Ru", "Rv", "Rw")))
            kind = "rigid_displacement" if d in "xyz" else "rigid_rotation"
            parts = (Component("rb", text=body), Component("dof", text=d), scaled(valued("value", value), lc),
                     Component("relative", text="1" if relative else "0"))  # fmt: skip
            made.append(self.rigid.add(Component("rigid_bc", kind, name, children=parts)))
        return made

    def push_body(self, body: str, *, curve: Any = None, name: str | None = None, **dofs: float) -> list[Node]:
        """Force (x, y, z) or moment (Ru, Rv, Rw) on a rigid body."""
        self._body(body)
        lc, made = resolved(self.model, curve), []
        for d, value in dofs.items():
            kind = "rigid_force" if d in ("x", "y", "z") else "rigid_moment"
            dof = f"R{d}" if d in ("x", "y", "z") else d
            parts = (Component("rb", text=body), Component("dof", text=dof), scaled(valued("value", value), lc))
            made.append(self.rigid.add(Component("rigid_load", kind, name, children=parts)))
        return made

    def _body(self, name: str) -> None:
        known = [m.name for m in self.model.record.materials if m.type == "rigid body" and m.name]
        if name not in known:
            raise InputError(missing("rigid body", name, known))


def _grouped(dofs: tuple[str, ...]) -> list[list[str]]:
    """Degrees of freedom by the condition that holds them; a condition holds one concentration."""
    out: dict[str, list[str]] = {}
    for d in dofs:
        if d not in BY_DOF:
            raise InputError(missing("degree of freedom", d, BY_DOF))
        out.setdefault(d if d[0] == "c" else str(BY_DOF[d].dofs), []).append(d)
    if not out:
        raise InputError("which degrees of freedom? x, y, z, p, c1, ...")
    return list(out.values())


def valued(tag: str, value: Any) -> Component:
    """A parameter that is a number, a formula (text) or a map (``{"map": name}``)."""
    if isinstance(value, dict) and set(value) == {"map"}:
        return Component(tag, "map", text=str(value["map"]))
    if isinstance(value, str):
        node = Node.of(Component(tag), tag)
        node.formula = value
        return node.component
    if not is_number(value):
        raise InputError(f"{tag} must be a number, a formula or {{'map': name}}, not {value!r}")
    return Component(tag, text=written(value))


def _filled(c: Component, parameters: dict[str, Any]) -> Component:
    """A component with parameters, each checked by name and value."""
    node = Node.of(c, c.type or c.tag)
    for k, v in parameters.items():
        setattr(node, k, v)
    return node.component

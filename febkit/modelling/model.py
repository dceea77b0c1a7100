"""``febkit.Model``: one object for a model that is read, built or made from a template."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import Domain, InputError, Mesh, Output, PlotVariable, Step, species
from febkit.model import Model as Record
from febkit.model.elements import domain
from febkit.model.species import Species

from . import meshes, selection
from .again import Again
from .curves import Curves
from .node import Node
from .output import Outputs
from .parts import Materials, Parts
from .sets import ElementSets, NodeSets, Surfaces
from .species import declared
from .stage import Stage
from .steps import Steps, StepView, control

if TYPE_CHECKING:
    from febkit.feb import Difference, Finding

    from .solution import Solution

Floats = NDArray[np.float64]
MODULES = ("solid", "biphasic", "solute", "multiphasic")
MIXTURE = (
    "displacement", "reaction forces", "effective fluid pressure", "fluid pressure", "stress", "Lagrange strain",
    "fluid flux",
)  # fmt: skip
PLOTS: dict[str, tuple[str, ...]] = {
    "solid": ("displacement", "reaction forces", "stress", "Lagrange strain"),
    "biphasic": (
        "displacement", "reaction forces", "effective fluid pressure", "stress", "Lagrange strain", "fluid flux",
    ),
    "solute": (*MIXTURE, "effective solute concentration", "solute concentration", "solute flux"),
    "multiphasic": (
        *MIXTURE, "effective solute concentration", "solute concentration", "solute flux", "electric potential",
        "current density", "fixed charge density", "osmolarity",
    ),
}  # fmt: skip


class Model(Stage):
    """A FEBio model: built, read, edited, checked, solved, written.

    >>> m = febkit.Model("biphasic", units="mm-N-s")                                    # doctest: +SKIP
    >>> m.add_cylinder("plug", radius=2, height=1, n=(4, 8))                            # doctest: +SKIP
    >>> m.materials["cartilage"] = febkit.materials.Biphasic(                           # doctest: +SKIP
    ...     solid=febkit.materials.NeoHookean(E=0.6, v=0.1),
    ...     permeability=febkit.materials.PermConstIso(perm=2e-3), phi0=0.2)
    >>> m.fix(m.nodes(z="min"), "z")                                                    # doctest: +SKIP
    >>> m.prescribe(m.nodes(z="max"), z=-0.1, curve=[(0, 0), (1, 1)])                   # doctest: +SKIP
    >>> m.step(time=100, dt=0.1, dtmax=10)                                              # doctest: +SKIP
    >>> result = m.solve()                                                              # doctest: +SKIP

    What the file says and nobody touches is written back byte for byte. ``model.record`` is the frozen record that
    the rest of febkit works with.
    """

    def __init__(self, module: str = "solid", *, units: str | None = None) -> None:
        if module not in MODULES:
            raise InputError(f'module {module!r}: choose from {", ".join(MODULES)}')
        empty = Mesh(np.zeros(0, np.int64), np.zeros((0, 3)))
        plots = PLOTS.get(module, PLOTS["biphasic"])
        self._record = Record("4.0", module, empty, units=units, output=Output(tuple(map(PlotVariable, plots))))
        self._again = Again()

    @property
    def model(self) -> Model:  # type: ignore[override]
        return self

    # ---- where models come from -------------------------------------------------------------------
    @classmethod
    def of(cls, record: Record | Model) -> Model:
        """The object of a record; a Model is given back as it is."""
        if isinstance(record, Model):
            return record
        return cls._like(record, Again())

    @classmethod
    def _like(cls, record: Record, again: Again) -> Model:
        out = cls.__new__(cls)
        out._record, out._again = record, again
        return out

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Model:
        """The model in a .feb file of version 1.0 to 4.0."""
        return read(path)

    @classmethod
    def from_meshio(cls, mesh: Any, module: str = "solid", *, units: str | None = None) -> Model:
        """A model of a mesh that meshio has or can read (gmsh with physical groups, Abaqus with sets, VTK, ...).

        Cells become parts named by their group or set, those of one dimension less surfaces, point sets node sets.
        """
        from febkit import meshio_format as formats

        record = formats.to_model(mesh if hasattr(mesh, "cells") else formats.read_mesh(mesh))
        out = cls(module, units=units)
        out._put(mesh=record.mesh)
        return out

    @classmethod
    def template(cls, name: str, **values: Any) -> Model:
        """A model of the study, "tissue", "cell" or "embedded"; ``febkit new NAME --parameters`` lists its values."""
        from febkit.templates import new

        return cls.of(new(name, **values))

    def copy(self) -> Model:
        """A model that may be changed without this one; what is the same is shared."""
        return Model._like(self._record, self._again)

    # ---- the record -------------------------------------------------------------------------------
    @property
    def record(self) -> Record:
        """The frozen record of the model as it is now."""
        return self._record

    def _put(self, **changes: Any) -> None:
        self._record = replace(self._record, **changes)

    def _step(self) -> Step:
        return self._record.common

    def _put_step(self, **changes: Any) -> None:
        self._put(common=replace(self._record.common, **changes))

    @property
    def module(self) -> str:
        """FEBio's module: solid, biphasic, ..."""
        return self._record.module

    @property
    def units(self) -> str | None:
        """FEBio's unit system ("mm-N-s", "SI", ...), None where the model names none."""
        return self._record.units

    @units.setter
    def units(self, name: str | None) -> None:
        self._put(units=name)

    @property
    def version(self) -> str:
        """Version of the .feb file it was read from."""
        return self._record.version

    @property
    def mesh(self) -> Mesh:
        """Nodes, elements and sets as arrays."""
        return self._record.mesh

    @property
    def constants(self) -> dict[str, float]:
        """Constants of <Globals> (T, R, Fc): a copy; set them by :meth:`set_constants`."""
        return dict(self._record.constants)

    def set_constants(self, **values: float) -> None:
        """Set constants of <Globals>: ``m.set_constants(T=298, R=8.314e-6, Fc=9.6485e-5)``."""
        self._put(constants={**self._record.constants, **{k: float(v) for k, v in values.items()}})

    # ---- mesh -------------------------------------------------------------------------------------
    def add_part(self, name: str, type: str, X: Any, connectivity: Any) -> None:
        """One more part: nodes X (n, 3) and elements (m, nodes of the element), 0-based rows of X."""
        self._put(mesh=meshes.joined(self.mesh, name, type, X, connectivity))
        held = self._record.materials
        if len(held) == 1 and held[0].type != "rigid body":
            self.assign(held[0].name or "", name)

    def add_block(self, name: str, size: Sequence[float], n: Sequence[int], origin: Sequence[float] = (0, 0, 0),
                  bias: Sequence[float] = (1, 1, 1)) -> None:  # fmt: skip
        """A box of hexahedra: see :func:`.meshes.block`."""
        self.add_part(name, "hex8", *meshes.block(size, n, origin, bias))

    def add_cylinder(self, name: str, radius: float, height: float, n: tuple[int, int] = (4, 4),
                     sector: str = "full", bias: float = 1.0) -> None:  # fmt: skip
        """A cylinder of hexahedra around z: see :func:`.meshes.cylinder`."""
        self.add_part(name, "hex8", *meshes.cylinder(radius, height, n, sector, bias))

    @property
    def X(self) -> Floats:
        """Reference positions of the nodes (n, 3)."""
        return self.mesh.X

    def nodes(self, *, part: str | None = None, **rules: Any) -> selection.Nodes:
        """Nodes by a rule: ``m.nodes(z="max")``, ``m.nodes(plane=(point, normal))``: see :func:`.selection.chosen`."""
        return selection.nodes(self.mesh, part=part, **rules)

    def faces(self, *, part: str | None = None, normal: Any = None, **rules: Any) -> selection.Faces:
        """Outer facets by a rule: ``m.faces(z="max")``, ``m.faces(normal=(0, 0, 1))``: see :func:`.selection.faces`."""
        return selection.faces(self.mesh, part=part, normal=normal, **rules)

    def elements(self, *, part: str | None = None, **rules: Any) -> selection.Elements:
        """Elements by their centres: see :func:`.selection.chosen`."""
        return selection.elements_of(self.mesh, part=part, **rules)

    @property
    def parts(self) -> Parts:
        """Element blocks by name, with their type, ids and material."""
        return Parts(self)

    @property
    def node_sets(self) -> NodeSets:
        return NodeSets(self)

    @property
    def surfaces(self) -> Surfaces:
        return Surfaces(self)

    @property
    def element_sets(self) -> ElementSets:
        return ElementSets(self)

    # ---- materials --------------------------------------------------------------------------------
    @property
    def materials(self) -> Materials:
        """Materials by name: ``m.materials["cartilage"].solid.E = 0.8``."""
        return Materials(self)

    def assign(self, material: str, *parts: str) -> None:
        """Give parts (all, where none is named) a material."""
        _ = self.materials[material]
        names = [b.name for b in self.mesh.blocks]
        for p in parts:
            _ = self.parts[p]
        own = {d.block: d for d in self._record.domains}
        for b in self.mesh.blocks:
            if not parts or b.name in parts:
                kind = domain(b.type)
                old = own.get(b.name)
                own[b.name] = Domain(b.name, kind, material) if old is None else replace(old, material=material)
        order = [n for n in names if n in own] + [n for n in own if n not in names]
        self._put(domains=tuple(own[n] for n in order))

    # ---- solutes ----------------------------------------------------------------------------------
    def solute(self, name: str, charge: int = 0, *, molar_mass: float = 1.0, density: float = 1.0) -> None:
        """One more solute: ``m.solute("Na+", charge=1)``; the first has the degree of freedom c1, and so on.

        charge: charge number; molar_mass and density make its molar volume, which only reactions need.
        """
        self._record = declared(self._record, "solute", name, charge, molar_mass, density)

    def solid_bound(self, name: str, charge: int = 0, *, molar_mass: float = 1.0, density: float = 1.0) -> None:
        """One more solid-bound molecule: ``m.solid_bound("CS", charge=-2, molar_mass=463e-9, density=1.5e-3)``.

        molar_mass (mass / mole) and density, true (mass / volume), turn its apparent density into charge and volume.
        """
        self._record = declared(self._record, "solid_bound", name, charge, molar_mass, density)

    @property
    def solutes(self) -> tuple[Species, ...]:
        """The solutes in the order of c1, c2, ..."""
        return species.solutes(self._record)

    @property
    def solid_bound_molecules(self) -> tuple[Species, ...]:
        """The solid-bound molecules in the model's order."""
        return species.solid_bound(self._record)

    # ---- curves, steps, output --------------------------------------------------------------------
    @property
    def curves(self) -> Curves:
        """Load curves by id: ``m.curves[1] = [(0, 0), (1, 1)]``."""
        return Curves(self)

    @property
    def steps(self) -> Steps:
        """The steps, by place or name; ``m.steps[0].control`` says how the first is solved."""
        return Steps(self)

    @property
    def control(self) -> Node:
        """The control of a model of one step."""
        if len(self.steps) != 1:
            raise InputError(f"the model has {len(self.steps)} steps: say which, m.steps[0].control")
        return self.steps[0].control

    def step(
        self, name: str | None = None, *, analysis: str | None = None, time: float = 1.0, dt: float = 0.1,
        dtmax: float | None = None, must_points: Sequence[float] | None = None, **how: Any,
    ) -> StepView:  # fmt: skip
        """One more step of ``time``, begun with steps of ``dt``.

        analysis: STATIC, STEADY-STATE, TRANSIENT (default in mixtures) or DYNAMIC; dtmax: longest step (dt by
        default); must_points: times that are met and written; fixed=True: steps of dt, no time stepper; retries,
        optimal (iterations aimed at), dtmin; plot: FEBio's plot_level; solver: parameters of the nonlinear solver,
        such as {"dtol": 1e-4}.
        """
        kind = analysis or ("STATIC" if self.module == "solid" else "TRANSIENT")
        spec = control(self, analysis=kind, time=time, dt=dt, dtmax=dtmax, must_points=must_points, **how)
        self._put(steps=(*self._record.steps, Step(name=name, control=spec)))
        return self.steps[-1]

    @property
    def output(self) -> Outputs:
        """What is written: ``m.output.plot``, ``m.output.log(...)``."""
        return Outputs(self)

    # ---- whole ------------------------------------------------------------------------------------
    def __getitem__(self, path: str) -> Any:
        """A parameter by FEBio's own path: ``m["fem.material('cartilage').solid.E"]``."""
        from .path import find

        return find(self, path).get()

    def __setitem__(self, path: str, value: Any) -> None:
        from .path import find

        find(self, path).put(value)

    def validate(self) -> list[Finding]:
        """What is wrong, as ``febkit validate`` finds it; empty where nothing is."""
        from febkit.feb import solvable
        from febkit.feb.validation import check

        found = check(self._record)
        return found if any(f.severity == "error" for f in found) else [*found, *solvable.ask(self._record)]

    def write(self, path: str | PathLike[str], version: str | None = None) -> list[str]:
        """Write a .feb file; what the version cannot say comes back, a line each. See :func:`febkit.write`."""
        from febkit.feb import write

        return write(self._record, path, version)

    def differences(self, other: Model | Record) -> list[Difference]:
        """What differs in meaning from another model."""
        from febkit.feb import diff

        return diff(self._record, Model.of(other)._record)

    def __eq__(self, other: object) -> bool:
        """Equal by meaning: names of conditions and ids that only number do not count."""
        return isinstance(other, (Model, Record)) and not self.differences(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        from .describe import model_lines

        return "\n".join(model_lines(self._record))

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(repr(self))}</pre>"

    def solve(self, plotfile: str | PathLike[str] | None = None, *, variables: Sequence[str] | None = None,
              at: Sequence[float] | None = None, **options: Any) -> Solution:  # fmt: skip
        """Solve the model in memory; ``result.dataset`` holds its fields: see :func:`.solution.solve`.

        plotfile: a file to write instead; variables: plot variables to keep; at: times to keep, met exactly;
        sensitivity: paths of parameters by which ``result.sensitivity`` has derivatives of all fields; other options
        (threads, progress, accuracy, ...) are those of :func:`febkit.solve`. A later solve of this model or of
        a copy finds what an edit left as it was: see :class:`.again.Again`.
        """
        from .solution import solve

        with self._again.lent() as again:
            return solve(self._record, plotfile, again, Model.of, variables=variables, at=at, **options)


def read(path: str | PathLike[str]) -> Model:
    """The model in a .feb file of version 1.0 to 4.0, with the files it includes.

    Raises InputError with file and line where it cannot be read.
    """
    from febkit.feb import read as records

    return Model.of(records(path))

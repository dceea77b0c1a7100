"""A boundary value problem as arrays: what :func:`febkit.solver.run` solves."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .fields import DISPLACEMENT, PRESSURE, Field, Layout
from .physics import default
from .record import variable_record
from .solids.base import Solid
from .solids.inert import Inert
from .values import Value

if TYPE_CHECKING:
    from .physics.base import Physics
    from .rigid.body import RigidBody
    from .rigid.connectors import Connector
    from .ties import LinearConstraint

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STATIC, STEADY, TRANSIENT, DYNAMIC = "static", "steady-state", "transient", "dynamic"


@variable_record
class Block:
    """Elements of one type and material. ``conn`` (m, n) 0-based, ``ids`` (m,) labels for messages.

    ``solid``: the law of the solid; ``physics``: what the elements solve for (:mod:`.physics`).
    ``axes`` (m, 3, 3) or (m, g, 3, 3): local material axes as columns, or None.
    """

    name: str
    element: str
    conn: Ints
    ids: Ints
    solid: Solid = field(default_factory=Inert)
    physics: Physics = field(default_factory=default)
    axes: Floats | None = None
    rule: str | None = None


@variable_record
class Fixed:
    """Holds one column at zero on nodes, where no earlier condition took the node."""

    column: int
    nodes: Ints


@variable_record
class Prescribed:
    """Prescribes one column on nodes: ``value(t, X[nodes], index within nodes)``.

    ``relative``: on top of the value at the start of the analysis step.
    """

    follows: ClassVar[bool] = False  # its values follow the solution (:mod:`.following`)
    column: int
    nodes: Ints
    value: Value
    relative: bool = False


@variable_record
class Initial:
    """Initial value of a column, or of the velocity of a displacement column."""

    column: int
    nodes: Ints
    value: Value
    velocity: bool = False


@variable_record
class Attached:
    """Nodes that move with a rigid body (its index)."""

    body: int
    nodes: Ints


@variable_record
class NewtonOptions:
    """Nonlinear solve (FEBio user manual, Control section; FEBio's names in brackets).

    method: "BFGS", "Broyden", "modified Newton" or "full Newton" [qn_method]; updates: quasi-Newton updates between
    reformations [max_ups]; dtol, ptol, ctol, etol, rtol: relative tolerances of displacement, fluid pressure,
    concentrations, energy and residual norm (0: not tested); tolerances: those of other fields, by the names of
    their options (:class:`.fields.Field`).
    """

    method: str = "BFGS"
    updates: int = 10
    buffer: int = 0
    cycle: bool = True
    cmax: float = 1e5
    dtol: float = DISPLACEMENT.tolerance
    etol: float = 1e-2
    rtol: float = 0.0
    ptol: float = PRESSURE.tolerance
    ctol: float = 1e-2
    tolerances: dict[str, float] = field(default_factory=dict)
    positive: bool = True  # concentrations below zero are taken as zero [force_positive_concentrations]
    max_reforms: int = 15
    reform_augment: bool = False
    diverge_reform: bool = True
    min_residual: float = 1e-20
    max_residual: float = 0.0
    line_tolerance: float = 0.9
    line_minimum: float = 0.01
    line_iterations: int = 5
    line_check_jacobians: bool = False
    symmetric: bool | None = None  # None: wherever the tangent is
    alpha: float = 1.0
    beta: float = 0.25
    gamma: float = 0.5
    rho_inf: float = -2.0
    descent: str = ""  # conjugate gradients instead of Newton's method: "Hager-Zhang" or "steepest descent" [cgmethod]
    arc_length: bool = False
    arc_length_scale: float = 0.0
    logarithmic: bool = False  # of residuals, from an analysis step's second time step on [logSolve]

    @property
    def full(self) -> bool:
        """Is the tangent renewed in every iteration?"""
        return self.updates == 0 or self.method == "full Newton"

    @property
    def between(self) -> bool:
        """Are forces of dynamic analyses taken before the step's end?"""
        return 0 <= self.rho_inf <= 1 or (self.rho_inf != -1 and self.alpha != 1.0)

    def tolerance(self, of: Field) -> float:
        """The tolerance of a field."""
        named = {"dtol": self.dtol, "ptol": self.ptol, "ctol": self.ctol}
        return self.tolerances.get(of.option, named.get(of.option, of.tolerance))


@variable_record
class AutoStep:
    """FEBio's time stepper [time_stepper]."""

    max_retries: int = 5
    optimal_iterations: int = 11
    dtmin: float = 0.0
    dtmax: float = 0.1
    dtmax_curve: Any = None  # callable of t; its points are the must points
    must_points: tuple[float, ...] = ()
    repeat: bool = False
    aggressive: bool = False
    cutback: float = 0.5
    force: bool = False


@variable_record
class Saving:
    """Which states are handed to listeners [plot_level, plot_stride, plot_range, plot_zero_state]."""

    level: str = "PLOT_MAJOR_ITRS"
    stride: int = 1
    range: tuple[int, int] = (0, -1)
    zero: bool = False


@variable_record
class Step:
    """One analysis step: conditions and loads that act during it, and how it is solved."""

    name: str = ""
    analysis: str = STATIC
    dt: float = 0.1
    count: int = 10  # steps of dt; the end time is count * dt
    duration: float | None = None
    auto: AutoStep | None = None
    newton: NewtonOptions = field(default_factory=NewtonOptions)
    saving: Saving = field(default_factory=Saving)
    fixed: list[Fixed] = field(default_factory=list)
    prescribed: list[Prescribed] = field(default_factory=list)
    conditions: list[Fixed | Prescribed] = field(default_factory=list)
    initial: list[Initial] = field(default_factory=list)
    loads: list[Any] = field(default_factory=list)
    body_loads: list[Any] = field(default_factory=list)
    attached: list[Attached] = field(default_factory=list)
    connectors: list[Connector] = field(default_factory=list)
    constraints: list[LinearConstraint] = field(default_factory=list)
    contacts: list[Any] = field(default_factory=list)  # see contact.base
    adaptors: list[Any] = field(default_factory=list)  # see erosion, refine
    explicit: Any = None  # central differences instead of equilibrium: see explicit
    again: bool = True  # a time step is solved again once adaptors changed the mesh [adaptor_re_solve]


@variable_record
class Progress:
    """Where the solve of a time step stands: iterations and augmentations done."""

    iterations: int = 0
    augmentations: int = 0


@variable_record
class Problem:
    """Nodes X (node, 3), element blocks, and steps. ``common`` acts in every step.

    Conditions on rigid body i name the rows len(X) + 2 i (displacement of the centre) and the next (rotation vector).
    ``fields``: the nodal fields where the blocks alone do not say them. ``origin``: what it was made of, for
    listeners; the solver knows nothing of it.
    """

    X: Floats
    blocks: list[Block]
    steps: list[Step]
    common: Step = field(default_factory=Step)
    node_ids: Ints | None = None
    bodies: list[RigidBody] = field(default_factory=list)
    fields: Layout | None = None
    origin: Any = None

    def __post_init__(self) -> None:
        self.X = np.ascontiguousarray(self.X, dtype=float)

    @property
    def layout(self) -> Layout:
        """Columns of the nodal fields: those given, or those of rigid bodies and blocks as they come."""
        if self.fields is not None:
            return self.fields
        return Layout.of([DISPLACEMENT] if self.bodies else [], *(b.physics.fields for b in self.blocks))

    @property
    def diffuses(self) -> bool:
        """Has some block rates besides those of inertia?"""
        return any(b.physics.rates for b in self.blocks)

"""<Control> to how a step is solved."""

from __future__ import annotations

import math

from febkit.model import Component, InputError, values
from febkit.solver.problem import DYNAMIC, STATIC, STEADY, TRANSIENT, AutoStep, NewtonOptions, Saving, Step

from .context import Context

ANALYSIS = {
    "static": STATIC, "steady-state": STEADY, "transient": TRANSIENT, "dynamic": DYNAMIC,
    "0": STATIC, "1": DYNAMIC,
}  # fmt: skip
BIPHASIC_ANALYSIS = {**ANALYSIS, "0": STEADY, "1": TRANSIENT, "static": STEADY}
SYMMETRY: dict[str, bool | None] = {
    "symmetric": True, "1": True, "true": True, "yes": True, "non-symmetric": None, "symmetric structure": None,
    "preferred": None, "0": None, "2": None, "false": None, "no": None,
}  # fmt: skip
LEVELS = (
    "PLOT_NEVER", "PLOT_MAJOR_ITRS", "PLOT_MINOR_ITRS", "PLOT_MUST_POINTS", "PLOT_FINAL", "PLOT_AUGMENTATIONS",
    "PLOT_STEP_FINAL",
)  # fmt: skip
KNOWN = frozenset({
    "analysis", "time_steps", "step_size", "final_time", "plot_zero_state", "plot_range", "plot_level",
    "output_level", "plot_stride", "output_stride", "adaptor_re_solve", "time_stepper", "solver", "print_level",
    "use_three_field_hex8", "restart",
})  # fmt: skip
SOLVER = frozenset({
    "symmetric_stiffness", "equation_scheme", "equation_order", "optimize_bw", "lstol", "lsmin", "lsiter",
    "ls_check_jacobians", "max_refs", "check_zero_diagonal", "zero_diagonal_tol", "force_partition",
    "reform_each_time_step", "reform_augment", "diverge_reform", "min_residual", "max_residual", "dtol", "etol",
    "rtol", "ptol", "ctol", "rhoi", "alpha", "beta", "gamma", "logSolve", "arc_length", "arc_length_scale",
    "qn_method", "mixed_formulation", "linear_solver", "init_accelerations",
})  # fmt: skip
QN = frozenset({"max_ups", "max_buffer_size", "cycle_buffer", "cmax"})


def step(ctx: Context, control: Component, out: Step) -> None:
    """Fill in how ``out`` is solved."""
    ctx.check_tags(control, KNOWN)
    names, usual = (BIPHASIC_ANALYSIS, TRANSIENT) if ctx.model.module == "biphasic" else (ANALYSIS, STATIC)
    out.analysis = control.choice("analysis", names, usual)
    out.dt, out.count = control.float("step_size", 0.1), control.int("time_steps", -1)
    if out.count < 0:
        out.duration = control.float("final_time", 0.0)
    end = end_time(out)
    if not (out.dt > 0 and 0 < end < math.inf):
        why = "nothing is solved" if end == 0 or out.dt == 0 else f"the step would end at t = {end:g}"
        raise InputError(
            "<Control> must give <time_steps> or <final_time>, and a <step_size>, of more than 0: " + why, control.where
        )
    stepper = control.child("time_stepper")
    out.auto = None if stepper is None else _auto(ctx, stepper, out)
    out.newton = _newton(ctx, control.child("solver"))
    out.saving = _saving(control)


def _auto(ctx: Context, c: Component, out: Step) -> AutoStep:
    ctx.check_tags(c, {
        "max_retries", "opt_iter", "dtmin", "dtmax", "aggressiveness", "cutback", "dtforce", "must_points",
    })  # fmt: skip
    leaf = c.child("dtmax")
    curved = leaf is not None and leaf.lc is not None  # the curve alone counts; FEBio takes an empty value then
    a = AutoStep(
        max_retries=c.int("max_retries", 5), optimal_iterations=c.int("opt_iter", 11),
        dtmin=c.float("dtmin", 0.0), dtmax=0.0 if curved else c.float("dtmax", 0.1),
        aggressive=c.bool("aggressiveness"), cutback=c.float("cutback", 0.5), force=c.bool("dtforce"),
    )  # fmt: skip
    if leaf is not None and leaf.lc is not None:
        a.dtmax_curve = ctx.controller(leaf.lc, leaf)
        spec = ctx.curves[leaf.lc]
        a.must_points = tuple(t for t, _ in spec.points)
        a.repeat = spec.spec.str("extend").upper() == "REPEAT"
    points = c.child("must_points")
    if points is not None and points.text.strip():
        a.must_points = points.as_floats()
    return a


def _newton(ctx: Context, c: Component | None) -> NewtonOptions:
    o = NewtonOptions(method="BFGS")
    if c is None:
        return o
    ctx.check_tags(c, SOLVER)
    if c.type not in (None, "solid", "biphasic"):
        ctx.refuse(f'<solver type="{c.type}">', c.where)
    for tag in ("arc_length", "logSolve", "mixed_formulation"):
        leaf = c.child(tag)
        if leaf is not None and leaf.text.strip().lower() not in ("", "0", "none", "false"):
            ctx.refuse(f"<{tag}>", leaf.where)
    numbers = {
        "dtol": "dtol", "etol": "etol", "rtol": "rtol", "ptol": "ptol", "min_residual": "min_residual",
        "max_residual": "max_residual", "lstol": "line_tolerance", "lsmin": "line_minimum", "rhoi": "rho_inf",
        "alpha": "alpha", "beta": "beta", "gamma": "gamma",
    }  # fmt: skip
    for tag, name in numbers.items():
        setattr(o, name, c.float(tag, getattr(o, name)))
    o.line_iterations = c.int("lsiter", o.line_iterations)
    o.line_check_jacobians = c.bool("ls_check_jacobians")
    # FEBio tests the count after each reformation, and 0 means none is allowed
    o.max_reforms = c.int("max_refs", o.max_reforms)
    o.reform_each_step = c.bool("reform_each_time_step", True)
    o.reform_augment = c.bool("reform_augment")
    o.diverge_reform = c.bool("diverge_reform", True)
    o.symmetric = c.choice("symmetric_stiffness", SYMMETRY, None)
    qn = c.child("qn_method")
    if qn is not None:
        _quasi_newton(ctx, qn, o)
    return o


def _quasi_newton(ctx: Context, c: Component, o: NewtonOptions) -> None:
    ctx.check_tags(c, QN)
    name = (c.type or c.text.strip() or o.method).lower()
    names = {"bfgs": "BFGS", "broyden": "Broyden", "full newton": "full Newton", "0": "BFGS", "1": "Broyden"}
    if name not in names:
        ctx.refuse(f'<qn_method type="{c.type}">', c.where)
        return
    o.method = names[name]
    o.updates = c.int("max_ups", 10)
    o.buffer = c.int("max_buffer_size", 0)
    o.cycle = c.bool("cycle_buffer", True)
    o.cmax = c.float("cmax", 1e5)


def _saving(c: Component) -> Saving:
    r = c.child("plot_range")
    span = (0, -1)
    if r is not None and r.text.strip():
        first, last = (values.integer(f"{x:.17g}", "<plot_range>", r.where) for x in r.as_floats(2))
        span = first, last
    names = {k.lower(): k for k in LEVELS} | {str(i): k for i, k in enumerate(LEVELS)}
    level = c.choice("plot_level", names, "PLOT_MAJOR_ITRS")
    return Saving(level, c.int("plot_stride", 1, least=1), span, c.bool("plot_zero_state"))


def end_time(s: Step) -> float:
    """Duration of a step."""
    return s.duration if s.duration is not None else s.dt * s.count


"""<Control> to how a step is solved."""

from __future__ import annotations

import math
from typing import Any

from febkit.model import Component, InputError, Where, ranges, values
from febkit.solver.problem import DYNAMIC, STATIC, STEADY, TRANSIENT, AutoStep, NewtonOptions, Saving, Step
from febkit.solver.stepping import SMALLEST

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
    "qn_method", "mixed_formulation", "force_positive_concentrations", "linear_solver", "init_accelerations",
    "use_new_rigid_update",
})  # fmt: skip
NUMBERS = {  # tags and options
    "dtol": "dtol", "etol": "etol", "rtol": "rtol", "ptol": "ptol", "ctol": "ctol", "min_residual": "min_residual",
    "max_residual": "max_residual", "lstol": "line_tolerance", "lsmin": "line_minimum", "rhoi": "rho_inf",
    "alpha": "alpha", "beta": "beta", "gamma": "gamma",
}  # fmt: skip
CONJUGATE = frozenset({  # tags of CG-solid; matrices and rates there are none of
    "dtol", "etol", "rtol", "min_residual", "lstol", "lsmin", "lsiter", "cgmethod", "preconditioner", "beta", "gamma",
    "equation_order", "equation_scheme", "optimize_bw", "symmetric_stiffness",
})  # fmt: skip
DESCENT = {"0": "Hager-Zhang", "1": "steepest descent"}
LAST = 3.4e38  # a time in a plotfile
SHORTEST = 1e-300  # beta dt^2 of dynamics, by which masses are divided
QN = frozenset({"max_ups", "max_buffer_size", "cycle_buffer", "cmax", "jfnk_eps"})


def step(ctx: Context, control: Component, out: Step) -> None:
    """Fill in how ``out`` is solved."""
    ctx.check_tags(control, KNOWN)
    names, usual = (ANALYSIS, STATIC) if ctx.model.module == "solid" else (BIPHASIC_ANALYSIS, TRANSIENT)
    out.analysis = control.choice("analysis", names, usual)
    _times(control, out)
    stepper = control.child("time_stepper")
    out.auto = None if stepper is None else _auto(ctx, stepper, out)
    solver = control.child("solver")
    if solver is not None and solver.type == "explicit-solid":
        out.explicit = _explicit(ctx, solver)
    elif solver is not None and solver.type == "CG-solid":
        out.newton = _conjugate(ctx, solver, control, out)
    else:
        out.newton = _newton(ctx, solver)
    if out.analysis == DYNAMIC:
        _check_integrator(control, out)
        if out.newton.arc_length and solver is not None:
            ctx.refuse("<arc_length> in a dynamic analysis", _where(solver, "arc_length"))
    if ctx.model.module == "solute":  # FEBio's solver for one neutral solute has these as they are
        out.newton.positive = out.newton.diverge_reform = True
    out.saving = _saving(control)
    out.again = control.bool("adaptor_re_solve", True)


def _times(c: Component, out: Step) -> None:
    """Step size and number of steps, or the end time where <time_steps> is -1 (FEBio's defaults: 10 steps of 0.1)."""
    out.dt, out.count = _number(c, "step_size", 0.1, above=0.0), c.int("time_steps", 10)
    final = c.child("final_time")
    if out.count == -1:
        out.duration = _number(c, "final_time", 0.0, above=0.0)
    elif out.count < 1:
        raise InputError(f"<time_steps> must be at least 1, or -1 for <final_time>, not {out.count}",
                         _where(c, "time_steps"))  # fmt: skip
    elif final is not None and c.child("time_steps") is None:
        raise InputError("<final_time> counts where <time_steps> is -1 only: give <time_steps>-1</time_steps> with it, "
                         "or leave it out for FEBio's 10 steps", final.where)  # fmt: skip
    end = end_time(out)
    if not end <= LAST:
        raise InputError(f"the end time {end:g} is too large: a plotfile holds times up to {LAST:.2g}", c.where)


def _check_integrator(c: Component, out: Step) -> None:
    """Raise InputError where Newmark's rule would divide by nothing."""
    o, solver = out.newton, c.child("solver")
    if o.rho_inf == -1 or 0 <= o.rho_inf <= 1:
        beta = 0.25
    else:
        beta = o.beta
        for tag, value in (("alpha", o.alpha), ("beta", o.beta)):
            if solver is not None and not value > 0:
                raise InputError(f"<{tag}> must be more than 0 in dynamics, not {value:g}", _where(solver, tag))
    if beta * out.dt**2 < SHORTEST:
        raise InputError(f"<step_size> is too small for a dynamic analysis: {out.dt:g}", _where(c, "step_size"))


def _where(c: Component, tag: str) -> Where:
    leaf = c.child(tag)
    return c.where if leaf is None else leaf.where


def _number(c: Component, tag: str, default: float, least: float = -math.inf, above: float = -math.inf) -> float:
    """A finite number of at least ``least`` and more than ``above``."""
    v = c.float(tag, default)
    if math.isfinite(v) and v >= least and v > above:
        return v
    limit = f" more than {above:g}" if above > -math.inf else f" of at least {least:g}" if least > -math.inf else ""
    raise InputError(f"<{tag}> must be a finite number{limit}, not {v:g}", _where(c, tag))


def _auto(ctx: Context, c: Component, out: Step) -> AutoStep:
    ctx.check_tags(c, {
        "max_retries", "opt_iter", "dtmin", "dtmax", "aggressiveness", "cutback", "dtforce", "must_points",
    })  # fmt: skip
    leaf = c.child("dtmax")
    curved = leaf is not None and leaf.lc is not None  # the curve alone counts; FEBio takes an empty value then
    a = AutoStep(
        max_retries=c.int("max_retries", 5), optimal_iterations=c.int("opt_iter", 11),
        dtmin=_number(c, "dtmin", 0.0, least=0.0), dtmax=0.0 if curved else _number(c, "dtmax", 0.1, least=0.0),
        aggressive=c.bool("aggressiveness"), cutback=_number(c, "cutback", 0.5, above=0.0), force=c.bool("dtforce"),
    )  # fmt: skip
    for tag, value, least in (("max_retries", a.max_retries, 0), ("opt_iter", a.optimal_iterations, 0)):
        if value < least:
            raise InputError(f"<{tag}> must be at least {least}, not {value}", _where(c, tag))
    if leaf is not None and leaf.lc is not None:
        _curve(ctx, leaf, leaf.lc, a, out)
    points = c.child("must_points")
    if points is not None and points.text.strip():
        a.must_points = points.as_floats()
        if not all(map(math.isfinite, a.must_points)):
            raise InputError("<must_points> must be finite numbers", points.where)
    return a


def _curve(ctx: Context, leaf: Component, number: int, a: AutoStep, out: Step) -> None:
    """The largest step by a load curve, whose points are must points."""
    a.dtmax_curve = ctx.controller(number, leaf)
    spec = ctx.curves[number]
    a.must_points = tuple(t for t, _ in spec.points)
    a.repeat = spec.spec.str("extend").upper() == "REPEAT"
    if len(a.must_points) < 2:
        raise InputError(f"<dtmax lc> asks for a load curve of two points at least; load controller {number} "
                         f"has {len(a.must_points)}", leaf.where)  # fmt: skip
    if a.repeat and not a.must_points[-1] > end_time(out) * SMALLEST:
        raise InputError(f"load controller {number} repeats: its last time, here {a.must_points[-1]:g}, must be more "
                         f"than {SMALLEST:g} of the end time", leaf.where)  # fmt: skip


def mixed(ctx: Context, c: Component) -> bool:
    """Are pressures of a lower order than displacements (<mixed_formulation>)?"""
    solver = c.child("solver")
    if solver is None or solver.child("mixed_formulation") is None:
        return False
    asked = solver.int("mixed_formulation") == 1
    if asked and ctx.model.module != "biphasic":
        ctx.refuse(f'<mixed_formulation> in a "{ctx.model.module}" model', solver.need("mixed_formulation").where)
    return asked


def _explicit(ctx: Context, c: Component) -> Any:
    """<solver type="explicit-solid">."""
    from febkit.solver.explicit import Central

    ctx.check_tags(c, {"mass_lumping", "dyn_damping"})
    lumping = c.choice("mass_lumping", {"0": 0, "1": 1, "2": 2}, 2)
    if lumping == 0:
        ctx.refuse("<mass_lumping>0</mass_lumping>, which FEBio lacks,", c.need("mass_lumping").where)
    return Central(lumping == 1, c.float("dyn_damping", 1.0))


def _conjugate(ctx: Context, c: Component, control: Component, out: Step) -> NewtonOptions:
    """<solver type="CG-solid">."""
    ctx.check_tags(c, CONJUGATE)
    if ctx.model.module != "solid":
        ctx.refuse(f"{c.what} in a {ctx.model.module} model", c.where)
    if out.analysis == DYNAMIC:
        raise InputError(f"{c.what} is for static analyses, as in FEBio", _where(control, "analysis"))
    if c.int("preconditioner", 0):
        ctx.refuse(f"<preconditioner> of {c.what}", _where(c, "preconditioner"))
    o = NewtonOptions(descent=c.choice("cgmethod", DESCENT, "Hager-Zhang"), dtol=1e-6, line_minimum=1e-15)
    for tag in ("dtol", "etol", "rtol", "min_residual", "lstol", "lsmin"):
        setattr(o, NUMBERS[tag], _number(c, tag, getattr(o, NUMBERS[tag]), least=0.0))
    o.line_iterations = c.int("lsiter", 10, least=0)
    return o


def _newton(ctx: Context, c: Component | None) -> NewtonOptions:
    o = NewtonOptions()  # BFGS in all modules: FEBio 4.11 names Broyden for mixtures, and takes BFGS all the same
    if c is None:
        return o
    ctx.check_tags(c, SOLVER)
    if c.type not in (None, "solid", "solid_old", "biphasic", "solute", "multiphasic"):
        ctx.refuse(f'<solver type="{c.type}">', c.where)
    _path(ctx, c, o)
    bounded = ranges.of("(solver)")  # by 0, all of them
    for tag, name in NUMBERS.items():
        setattr(o, name, _number(c, tag, getattr(o, name), least=0.0 if tag in bounded else -math.inf))
    o.line_iterations = c.int("lsiter", o.line_iterations)
    o.line_check_jacobians = c.bool("ls_check_jacobians")
    # FEBio tests the count after each reformation, and 0 means none is allowed
    o.max_reforms = c.int("max_refs", o.max_reforms)
    c.bool("reform_each_time_step", True)  # it is, whatever the file says
    o.reform_augment = c.bool("reform_augment")
    o.diverge_reform = c.bool("diverge_reform", True)
    o.positive = c.bool("force_positive_concentrations", True)
    o.symmetric = c.choice("symmetric_stiffness", SYMMETRY, None)
    qn = c.child("qn_method")
    if qn is not None:
        _quasi_newton(ctx, qn, o)
    return o


def _path(ctx: Context, c: Component, o: NewtonOptions) -> None:
    """Arc length, and the logarithm of residuals: FEBio's solver for solids has them."""
    o.arc_length = c.choice("arc_length", {"": False, "0": False, "none": False, "1": True, "crisfield": True}, False)
    o.arc_length_scale = _number(c, "arc_length_scale", 0.0, least=0.0)
    o.logarithmic = c.bool("logSolve")
    for tag, on in (("arc_length", o.arc_length), ("logSolve", o.logarithmic)):
        if on and (ctx.model.module != "solid" or c.type not in (None, "solid")):
            ctx.refuse(f'<{tag}> outside of <Module type="solid">', _where(c, tag))
    if o.arc_length and o.logarithmic:
        ctx.refuse("<logSolve> with <arc_length>", _where(c, "logSolve"))


def _quasi_newton(ctx: Context, c: Component, o: NewtonOptions) -> None:
    ctx.check_tags(c, QN)
    name = (c.type or c.text.strip() or o.method).lower()
    names = {"bfgs": "BFGS", "broyden": "Broyden", "full newton": "full Newton", "0": "BFGS", "1": "Broyden"}
    names |= {"modified newton": "modified Newton", "jfnk": "full Newton"}  # JFNK: the same steps without a matrix
    if name not in names:
        ctx.refuse(f'<qn_method type="{c.type}">', c.where)
        return
    o.method = names[name]
    o.updates = c.int("max_ups", 10)
    o.buffer = c.int("max_buffer_size", 0)
    o.cycle = c.bool("cycle_buffer", True)
    o.cmax = _number(c, "cmax", 1e5, least=0.0)


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

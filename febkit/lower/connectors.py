"""<rigid_connector> to connectors of two rigid bodies."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.model import Component, InputError
from febkit.solver.problem import Step
from febkit.solver.rigid import connectors as between
from febkit.solver.rigid import joints

from . import rigid
from .context import METHODS, Context

#: kind -> class, and tags with the fields they fill: numbers that may follow a curve, points, flags
KINDS: dict[str, tuple[Any, dict[str, str], tuple[str, ...], tuple[str, ...]]] = {
    "rigid spring": (between.Spring, {"k": "k"}, ("insertion_a", "insertion_b"), ()),
    "rigid damper": (between.Damper, {"c": "c"}, ("insertion_a", "insertion_b"), ()),
    "rigid angular damper": (between.AngularDamper, {"c": "c"}, (), ()),
    "rigid contractile force": (between.ContractileForce, {"f0": "f0"}, ("insertion_a", "insertion_b"), ()),
    "rigid joint": (joints.RigidJoint, {}, ("joint",), ()),
    "generic rigid joint": (joints.GenericJoint, {}, ("joint",), ()),
    "rigid lock": (joints.Lock, {}, (), ()),
    "rigid spherical joint": (joints.Spherical, {}, (), ("prescribed_rotation",)),
    "rigid revolute joint": (
        joints.Revolute, {"rotation": "rotation", "moment": "applied_moment"}, (), ("prescribed_rotation",),
    ),
    "rigid prismatic joint": (
        joints.Prismatic, {"translation": "translation", "force": "applied_force"}, (), ("prescribed_translation",),
    ),
    "rigid cylindrical joint": (
        joints.Cylindrical,
        {"translation": "translation", "force": "applied_force", "rotation": "rotation", "moment": "applied_moment"},
        (), ("prescribed_translation", "prescribed_rotation"),
    ),
    "rigid planar joint": (
        joints.Planar, {n: n for n in ("rotation", "translation_1", "translation_2")}, (),
        ("prescribed_rotation", "prescribed_translation_1", "prescribed_translation_2"),
    ),
}  # fmt: skip
SIZES = ("tolerance", "gaptol", "angtol", "force_penalty", "moment_penalty")
GENERIC = tuple(f"prescribe_{q}" for q in ("x", "y", "z", "Rx", "Ry", "Rz"))
DAMPING = ("force_damping", "moment_damping")
TURNS, MOMENTS = tuple(f"rotation_{k}" for k in "xyz"), tuple(f"moment_{k}" for k in "xyz")


def read(ctx: Context, out: Step, c: Component) -> None:
    """Add a connector to a step."""
    if c.type not in KINDS:
        ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
        return
    cls, numbers, points, flags = KINDS[c.type]
    known = {"body_a", "body_b", *numbers, *points, *flags}
    kw: dict[str, Any] = {
        field: ctx.value(c.child(tag)) for tag, field in numbers.items() if c.child(tag) is not None
    }
    kw |= {tag: np.array(c.need(tag).as_floats(3)) for tag in points if c.child(tag) is not None}
    kw |= {tag: c.bool(tag) for tag in flags}
    if cls is between.Spring:
        known.add("free_length")
        kw["free_length"] = c.float("free_length", 0.0)
    elif cls is joints.RigidJoint:
        known |= {"tolerance", "penalty", "laugon"}
        kw |= {tag: c.float(tag, 0.01 if tag == "tolerance" else 0.0) for tag in ("tolerance", "penalty")}
        if not kw["penalty"]:
            raise InputError(f'<{c.tag} type="{c.type}"> needs a <penalty>', c.where)
    elif cls is joints.GenericJoint:
        known |= {"tolerance", "penalty", "laugon", "symmetric_stiffness", *GENERIC}
        kw |= {"tolerance": c.float("tolerance", 0.0), "penalty": c.float("penalty", 1.0)}
        kw["given"] = tuple(None if c.child(t) is None else ctx.value(c.child(t)) for t in GENERIC)
    elif issubclass(cls, joints.Joint):
        known |= _joint(ctx, c, cls, kw)
    if issubclass(cls, (joints.Joint, joints.RigidJoint, joints.GenericJoint)):
        kw["laugon"] = _method(ctx, c, 0 if cls is joints.GenericJoint else 1)
    ctx.check_tags(c, known)
    out.connectors.append(cls(rigid.body(ctx, c, "body_a"), rigid.body(ctx, c, "body_b"), **kw))


def _joint(ctx: Context, c: Component, cls: Any, kw: dict[str, Any]) -> set[str]:
    """Fields that joints have in common; returns their tags."""
    known = {*SIZES, "joint_origin", "minaug", "maxaug", "auto_penalty", "laugon", *filter(None, cls.AXES)}
    sizes: tuple[str, ...] = SIZES
    if cls in (joints.Revolute, joints.Prismatic):
        sizes += DAMPING
    kw |= {tag: c.float(tag) for tag in sizes if c.child(tag) is not None}
    kw["origin"] = np.array(c.need("joint_origin").as_floats(3))
    kw["minaug"], kw["maxaug"] = c.int("minaug", 0), c.int("maxaug", 10)
    kw["auto_penalty"] = c.bool("auto_penalty")
    if cls.AXES[0]:
        default = (0, 0, 1), (1, 0, 0)
        if cls is joints.Prismatic:
            default = (1, 0, 0), (0, 1, 0)
        leaves = [c.child(tag) for tag in cls.AXES]
        given = [np.array(d if q is None else q.as_floats(3), float) for q, d in zip(leaves, default)]
        if not np.linalg.norm(np.cross(given[0], given[1])) > 0:
            tags = " and ".join(f"<{t}>" for t in cls.AXES)
            raise InputError(f"{c.what}: {tags} must not be parallel or zero", c.where)
        kw["axes"] = joints.axes(*given)
    if cls is joints.Spherical:
        known |= {*TURNS, *MOMENTS}
        kw["rotations"] = tuple(ctx.value(c.child(tag), 0.0) for tag in TURNS)
        kw["moments"] = tuple(ctx.value(c.child(tag), 0.0) for tag in MOMENTS)
    return known | set(sizes)


def _method(ctx: Context, c: Component, otherwise: int) -> int:
    """0 penalty, 1 augmented Lagrangian, ``otherwise`` FEBio's default; Lagrange multipliers are refused."""
    method = c.choice("laugon", METHODS, otherwise)
    if method == 2:
        ctx.refuse(f"<laugon>LAGMULT</laugon> of {c.what}", c.need("laugon").where)
    return method

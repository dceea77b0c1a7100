"""Degrees of freedom by the conditions that name them (FEBio 4.11: FEBioMech, FEBioMix, FEBioFluid)."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Group:
    """``fixed``/``prescribed``: types of version 4.0; ``initial`` likewise, where there is one."""

    dofs: tuple[str, ...]
    fixed: str | None
    prescribed: str | None
    initial: str | None = None
    named: bool = True  # <dof> and <x_dof> say which; else the type says it

    def flag(self, dof: str) -> str:
        return "c_dof" if re.fullmatch(r"c\d+", dof) else f"{dof}_dof"


_SOLUTES = tuple(f"c{i}" for i in range(1, 9))
_SHELL_SOLUTES = tuple(f"d{i}" for i in range(1, 9))
GROUPS = (
    Group(("x", "y", "z"), "zero displacement", "prescribed displacement"),
    Group(("u", "v", "w"), "zero rotation", "prescribed rotation"),
    Group(("sx", "sy", "sz"), "zero shell displacement", "prescribed shell displacement"),
    Group(("p",), "zero fluid pressure", "prescribed fluid pressure", "initial fluid pressure", False),
    Group(("q",), None, "prescribed shell fluid pressure", "initial shell fluid pressure", False),
    Group(("wx", "wy", "wz"), "zero fluid velocity", "prescribed fluid velocity"),
    Group(("gx", "gy", "gz"), "zero fluid angular velocity", "prescribed fluid angular velocity"),
    Group(("ef",), "zero fluid dilatation", "prescribed fluid dilatation", "initial fluid dilatation", False),
    Group(("T",), "zero temperature", "prescribed temperature", "initial temperature", False),
    Group(_SOLUTES, "zero concentration", "prescribed concentration", "initial concentration"),
    Group(_SHELL_SOLUTES, None, None, "initial shell concentration"),
)
BY_DOF = {d: g for g in GROUPS for d in g.dofs}
BY_FIXED = {g.fixed: g for g in GROUPS if g.fixed}
BY_PRESCRIBED = {g.prescribed: g for g in GROUPS if g.prescribed}
BY_INITIAL = {g.initial: g for g in GROUPS if g.initial}
_RUN = re.compile(r"(xyz|xy|yz|xz|uvw|uv|vw|uw|sxyz|sxy|syz|sxz|wxyz|wxy|wyz|wxz|gxyz|gxy|gyz|gxz)")


def parse(text: str) -> list[str] | None:
    """Dofs of "x,y,z", "xyz", "xyzuvw", "sxy", "c1", ...; None where one is unknown."""
    out: list[str] = []
    for word in re.split(r"[,\s;]+", text.strip()):
        if not word:
            continue
        if word == "t":
            word = "T"
        if word in BY_DOF:
            out.append(word)
            continue
        found = _run(word)
        if found is None:
            return None
        out += found
    return list(dict.fromkeys(out))


def _run(word: str) -> list[str] | None:
    out: list[str] = []
    while word:
        m = _RUN.match(word)
        if m is None:
            return None
        run, word = m.group(1), word[m.end():]
        if run[0] in "swg" and len(run) > 2 and run[1] in "xyz":
            out += [run[0] + c for c in run[1:]]
        else:
            out += list(run)
    return out

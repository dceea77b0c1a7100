"""Constructors of materials: ``febkit.materials.NeoHookean(E=0.6, v=0.1)``.

Each carries FEBio's parameters, with defaults and help made from the solver's own records; every FEBio material is
there by its type name as well: ``febkit.materials.of("neo-Hookean", E=0.6, v=0.1)``. A parameter is a number, a formula
of X, Y, Z and t (text), or, for a property, another material. Reactions take ``vR={"species": coefficient}``,
``vP`` likewise, those of membranes ``vRe``, ``vPe``, ``vRi`` and ``vPi`` besides.
"""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from febkit.modelling.node import Node

MIXTURES = ("biphasic", "biphasic-solute", "triphasic", "multiphasic", "rigid body")


@cache
def names() -> dict[str, str]:
    """FEBio's type of each constructor's name."""
    from febkit.feb.features import table
    from febkit.modelling.schema import mixture_laws
    from febkit.solver import membrane_reactions, reactions
    from febkit.solver.solids.registry import tables

    laws = [r.TYPES for r in (*mixture_laws(), reactions, membrane_reactions)]
    kinds = [t for types in (*tables().values(), *laws) for t in types]
    kinds += table()["material"]
    out: dict[str, str] = {}
    for kind in kinds:
        out.setdefault(name_of(kind), kind)
    return out


def name_of(kind: str) -> str:
    """The constructor's name of a FEBio type: "neo-Hookean" is NeoHookean, "2D trans iso ..." ends in 2D."""
    words = [w for w in re.split(r"\W+", kind) if w]
    if words and words[0][0].isdigit():
        words = [*words[1:], words[0]]
    return "".join(w[0].upper() + w[1:] for w in words)


def of(type: str, /, **parameters: Any) -> Node:
    """A material, or a property of one, by FEBio's type name. InputError names a parameter that FEBio does not know."""
    from febkit.feb.features import anywhere
    from febkit.model import Component, InputError
    from febkit.modelling.node import Node
    from febkit.modelling.sets import missing

    if type not in anywhere():
        raise InputError(missing("material", type, [*names().values()]))
    node = Node.of(Component("material", type), type)
    for name, value in parameters.items():
        if name in ("vR", "vP", "vRe", "vPe", "vRi", "vPi") and isinstance(value, dict):
            _add_stoichiometry(node, name, value)
        elif isinstance(value, (list, tuple)) and value and all(isinstance(v, Node) for v in value):
            for v in value:
                node.add(name, v)
        elif value is not None:
            try:
                setattr(node, name, value)
            except AttributeError as e:
                raise InputError(str(e)) from None
    return node


def Solute(name: str, *, diffusivity: Node, solubility: Node, supply: Node | None = None) -> Node:
    """A solute of a mixture, by its name in the model: ``m.solute(name, charge=...)`` declares it.

    diffusivity: DiffConstIso(free_diff=, diff=), ...; solubility: SolubConst(solub=), ...; supply: in BiphasicSolute.
    """
    return _species("solute", "sol", name, {"diffusivity": diffusivity, "solubility": solubility, "supply": supply})


def SolidBound(name: str, *, rho0: Any = 0.0, rhomin: float = 0.0, rhomax: float = 0.0) -> Node:
    """A solid-bound molecule of a mixture, by its name in the model: ``m.solid_bound(name, ...)`` declares it.

    rho0, rhomin, rhomax: initial, least and largest apparent density (mass / reference volume); rhomax 0: no limit.
    """
    return _species("solid_bound", "sbm", name, {"rho0": rho0, "rhomin": rhomin, "rhomax": rhomax})


def _species(tag: str, attribute: str, name: str, parameters: dict[str, Any]) -> Node:
    from febkit.model import Component
    from febkit.modelling.node import Node

    node = Node.of(Component(tag, attrs={attribute: name}), f"{tag} {name}")
    for k, v in parameters.items():
        if v is not None:
            node[k] = v
    return node


def _add_stoichiometry(node: Node, tag: str, coefficients: dict[str, int]) -> None:
    """vR={"A": 1, "B": 2}: stoichiometric coefficients by species."""
    from febkit.model import Component

    for name, n in coefficients.items():
        node.add(tag, Component(tag, attrs={"species": name}, children=(Component(tag, text=str(n)),)))


@cache
def constructor(name: str) -> Callable[..., Node]:
    """The constructor called ``name``, with its own signature and help. KeyError where there is none."""
    import inspect

    from febkit.model import Component
    from febkit.modelling import schema

    kind = names()[name]

    def make(**parameters: Any) -> Node:
        return of(kind, **parameters)

    c = Component("material", kind)
    cls = schema.record(c)
    known = sorted(schema.parameters(c), key=lambda t: (t == "density", t))
    if cls is not None:
        first = [*cls.parameters, *getattr(cls, "properties", {})]
        place = {schema.attribute(f): k for k, f in enumerate(first)}
        known.sort(key=lambda t: place.get(schema.attribute(t), 99))
    empty = inspect.Parameter.empty
    parameters = []
    for t in known:
        value = schema.default(c, t)
        parameters.append(inspect.Parameter(
            schema.attribute(t), inspect.Parameter.KEYWORD_ONLY, default=empty if cls is not None and value is None and
            t in getattr(cls, "parameters", ()) else value))  # fmt: skip
    make.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    make.__name__ = make.__qualname__ = name
    doc = inspect.getdoc(cls) if cls is not None else ""
    make.__doc__ = f'FEBio\'s "{kind}".\n\n{doc}'.rstrip()
    return make


def __getattr__(name: str) -> Any:
    if not name.startswith("_") and name in names():
        return constructor(name)
    from difflib import get_close_matches

    close = [] if name.startswith("_") else get_close_matches(name, names(), 1, 0.6)
    hint = f"; did you mean {close[0]}?" if close else ""
    raise AttributeError(f"febkit.materials has no {name}{hint}")


def __dir__() -> list[str]:
    return sorted({"of", "Solute", "SolidBound", *names()})

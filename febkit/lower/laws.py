"""Laws that are one record of parameters: permeabilities, supplies, and the laws of solutes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from febkit.model import Component, InputError

from .context import Context

Special = Callable[[Component], Any]


def law(ctx: Context, spec: Component, registry: Any, part: str, special: Special | None = None) -> Any:
    """The law that ``spec`` names among those of ``registry``; None where it is refused.

    ``special`` reads the parameters that are no numbers, and gives None for those it does not know.
    """
    if spec.type is None or not registry.known(spec.type):
        ctx.refuse(f'<{spec.tag} type="{spec.type}">', spec.where)
        return None
    cls = registry.load(spec.type)
    fields: dict[str, Any] = {}
    for c in spec:
        value = _parameter(ctx, c, cls, part, special)
        if value is None:
            ctx.refuse(f'<{c.tag}> of <{spec.tag} type="{spec.type}">', c.where)
        else:
            fields[c.tag] = value
    defaults = cls.defaults()
    for name in cls.parameters:
        if name not in fields and name not in defaults:
            raise InputError(f'<{spec.tag} type="{spec.type}"> lacks <{name}>', spec.where)
    for name in cls.needed:
        if name not in fields:
            raise InputError(f'<{spec.tag} type="{spec.type}"> lacks <{name}>', spec.where)
    return cls(**fields)


def _parameter(ctx: Context, c: Component, cls: Any, part: str, special: Special | None) -> Any:
    if c.tag == "mat_axis":
        from . import axes

        return axes.mat_axis(ctx, c, part)
    if c.tag in cls.vectors:
        return ctx.components(c, cls.vectors[c.tag])
    if c.tag in cls.parameters:
        return ctx.value(c, maps=part)
    return None if special is None else special(c)

"""What a <var type="name['more']=alias"> of a <plotfile> asks for."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from febkit.record import value_record

if TYPE_CHECKING:
    from febkit.model import PlotVariable

_BRACKETS = re.compile(r"""([^\[]*)\[\s*(?:'(.*)'|"(.*)"|([^'"]*))\s*\]\s*""")


@value_record
class Asked:
    """``more`` is what stands in the brackets, ``label`` the name in the plotfile; where ``surface`` or ``part`` is
    given, the values of that one alone are written."""

    name: str
    more: tuple[str, ...]
    label: str
    surface: str | None = None
    part: str | None = None

    @classmethod
    def of(cls, v: PlotVariable) -> Asked:
        found = _BRACKETS.fullmatch(v.type)
        name = v.type.strip()
        more: tuple[str, ...] = ()
        if found is not None:
            name = found[1].strip()
            more = (next(q for q in found.groups()[1:] if q is not None).strip(),)
        part = v.spec.attrs.get("elem_set") if v.spec is not None else None
        return cls(name, more, v.alias or v.type, v.surface, part)

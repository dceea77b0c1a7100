"""Parts (element blocks) and materials of a model, by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, MutableMapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import Component, Domain, ElementBlock, InputError
from febkit.model.elements import domain

from .node import Node
from .sets import missing
from .text import is_number, written

if TYPE_CHECKING:
    from .model import Model


@dataclass(eq=False)
class Part:
    """A part: ``type`` of its elements, their ``ids`` and ``connectivity`` (0-based), its ``material``."""

    model: Model
    name: str

    @property
    def _block(self) -> ElementBlock:
        return self.model.record.mesh.block(self.name)

    @property
    def type(self) -> str:
        return self._block.type

    @property
    def ids(self) -> NDArray[np.int64]:
        return self._block.ids

    @property
    def connectivity(self) -> NDArray[np.int64]:
        return self._block.conn

    @property
    def material(self) -> str | None:
        """The name of its material."""
        return next((d.material for d in self.model.record.domains if d.block == self.name), None)

    @property
    def thickness(self) -> float | None:
        """Thickness of the shells of the part (length); None where it is not said, or said by a map."""
        d = self._domain
        return d.spec.float("shell_thickness", 0.0) or None if d is not None and d.spec is not None else None

    @thickness.setter
    def thickness(self, value: float) -> None:
        if domain(self.type) != "shell":
            raise InputError(f'part "{self.name}" holds {self.type}, which have no thickness')
        if not (is_number(value) and float(value) > 0):
            raise InputError(f"the thickness of shells must be more than 0, not {value!r}")
        d = self._domain or Domain(self.name, "shell", "")
        rest = d.spec or Component("ShellDomain")
        kept = tuple(c for c in rest.children if c.tag != "shell_thickness")
        said = Component("shell_thickness", text=written(value))
        new = replace(d, spec=replace(rest, children=(*kept, said)))
        others = tuple(x for x in self.model.record.domains if x.block != self.name)
        own = {x.block: x for x in (*others, new)}
        order = [b.name for b in self.model.record.mesh.blocks if b.name in own]
        self.model._put(domains=tuple(own[n] for n in order))

    @property
    def _domain(self) -> Domain | None:
        return next((d for d in self.model.record.domains if d.block == self.name), None)

    def assign(self, material: str) -> None:
        """Give it a material."""
        self.model.assign(material, self.name)

    def __repr__(self) -> str:
        return f"part {self.name}: {len(self.ids)} {self.type}, material {self.material or '-'}"


class Parts(Mapping[str, Part]):
    """Parts by name."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def __getitem__(self, name: str) -> Part:
        known = list(self)
        if name not in known:
            raise KeyError(missing("part", name, known))
        return Part(self._model, name)

    def __iter__(self) -> Iterator[str]:
        return (b.name for b in self._model.record.mesh.blocks)

    def __len__(self) -> int:
        return len(self._model.record.mesh.blocks)

    def __repr__(self) -> str:
        return "\n".join(map(repr, self.values())) or "no parts"

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)


class Materials(MutableMapping[str, Node]):
    """Materials by name. The first one that is put in goes to all parts that have none."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def _place(self, name: str) -> int:
        names = list(self)
        if name not in names:
            raise KeyError(missing("material", name, names))
        return names.index(name)

    def __getitem__(self, name: str) -> Node:
        _ = self._place(name)

        def put(new: Component) -> None:
            at, held = self._place(name), self._model.record.materials
            self._model._put(materials=(*held[:at], new, *held[at + 1 :]))

        return Node(lambda: self._model.record.materials[self._place(name)], put, self._component(name).type or name)

    def _component(self, name: str) -> Component:
        return self._model.record.materials[self._place(name)]

    def __setitem__(self, name: str, given: Any) -> None:
        c = given.component if isinstance(given, Node) else given
        if not isinstance(c, Component) or not c.type:
            raise InputError("a material is made by febkit.materials, such as febkit.materials.NeoHookean(E=1, v=0.3)")
        held = self._model.record.materials
        if name in self:
            at = self._place(name)
            new = replace(c, tag="material", name=name, id=held[at].id)
            self._model._put(materials=(*held[:at], new, *held[at + 1 :]))
            return
        number = 1 + max((m.id or k for k, m in enumerate(held, 1)), default=0)
        self._model._put(materials=(*held, replace(c, tag="material", name=name, id=number)))
        bare = [p.name for p in self._model.parts.values() if not p.material]
        if not held and bare and c.type != "rigid body":
            self._model.assign(name, *bare)

    def __delitem__(self, name: str) -> None:
        at, held = self._place(name), self._model.record.materials
        used = [p.name for p in self._model.parts.values() if p.material == name]
        if used:
            raise InputError(f'the material "{name}" is that of {", ".join(used)}: give these another one first')
        self._model._put(materials=(*held[:at], *held[at + 1 :]))

    def __iter__(self) -> Iterator[str]:
        return (m.name or f"Material{m.id}" for m in self._model.record.materials)

    def __len__(self) -> int:
        return len(self._model.record.materials)

    def __repr__(self) -> str:
        return "\n".join(repr(self[n]) for n in self) or "no materials"

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)

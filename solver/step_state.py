"""What a try at a time step may change, remembered as the step begins and given back where the try fails."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol


class Part(Protocol):
    """Nodal values, elements of a group, a load, a connector, a contact, Newton's iteration.

    A snapshot is made of dicts, lists, tuples, numbers and arrays, so that it can be kept on disk as well
    (:mod:`.checkpoint`); a part takes one back any number of times, tuples as lists too.
    """

    def snapshot(self) -> Any: ...

    def restore(self, saved: Any) -> None: ...


class StepState:
    """What each of ``parts`` says that it keeps: values, histories, multipliers, penalties, neighbours."""

    def __init__(self, parts: Sequence[Part]) -> None:
        self.parts, self._kept = parts, [p.snapshot() for p in parts]

    def restore(self) -> None:
        """Everything as it was; any number of times."""
        for part, kept in zip(self.parts, self._kept, strict=True):
            part.restore(kept)

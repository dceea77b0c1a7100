"""What a try at a time step may change, remembered as the step begins and given back where the try fails."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from .state import State


class Part(Protocol):
    """Elements of a group, a load, a connector, a contact, Newton's iteration."""

    def snapshot(self) -> Any: ...

    def restore(self, saved: Any) -> None: ...


class StepState:
    """Nodal arrays, and what each of ``parts`` says that it keeps: histories, multipliers, penalties, neighbours."""

    def __init__(self, state: State, parts: Sequence[Part]) -> None:
        self.state, self.parts = state, parts
        self._nodal, self._kept = state.copy(), [p.snapshot() for p in parts]

    def restore(self) -> None:
        """Everything as it was; any number of times."""
        for name, value in vars(self._nodal.copy()).items():
            setattr(self.state, name, value)
        for part, kept in zip(self.parts, self._kept, strict=True):
            part.restore(kept)

"""What a second solve of a model finds of the first: all that its parameters do not change."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from febkit.solver.graph import Graphs


class Again:
    """Sparsity of the tangent and the order of its elimination (:class:`febkit.solver.graph.Graphs`).

    All of it is found by the content of what it was made of: an edit makes anew what it touches, and nothing else.
    A model and its copies share one. Copied to another process, or by ``copy.deepcopy``, it is empty.
    """

    def __init__(self) -> None:
        self._free = Lock()
        self._graphs: Graphs | None = None

    @contextmanager
    def lent(self) -> Iterator[Again]:
        """Itself, to one run at a time; to another one meanwhile an empty one."""
        if not self._free.acquire(blocking=False):
            yield Again()
            return
        try:
            yield self
        finally:
            self._free.release()

    @property
    def graphs(self) -> Graphs:
        if self._graphs is None:
            from febkit.solver.graph import Graphs

            self._graphs = Graphs()
        return self._graphs

    def __reduce__(self) -> tuple[Any, ...]:
        return Again, ()

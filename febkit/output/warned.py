"""What the solver warns of while it runs, to whoever started the run."""

from __future__ import annotations

from collections.abc import Callable

from febkit.solver.run import Listener, Run


class WarningListener(Listener):
    """Hands warnings on as they come."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.tell = tell

    def warning(self, run: Run, message: str) -> None:
        self.tell(message)

"""Where the time goes: seconds by part of the work."""

from __future__ import annotations

from .compilation import now


class Clock:
    """Adds up wall seconds by name: ``with clock("tangent"): ...``, one part at a time; compiling is not counted."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._parts: dict[str, _Part] = {}

    def __call__(self, part: str) -> _Part:
        if part not in self._parts:
            self._parts[part] = _Part(self.seconds, part)
        return self._parts[part]


class _Part:
    """One name of a clock."""

    __slots__ = ("name", "seconds", "start")

    def __init__(self, seconds: dict[str, float], name: str) -> None:
        self.seconds, self.name, self.start = seconds, name, 0.0

    def __enter__(self) -> None:
        self.start = now()

    def __exit__(self, *failure: object) -> None:
        self.seconds[self.name] = self.seconds.get(self.name, 0.0) + now() - self.start

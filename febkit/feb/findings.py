"""What a check of an input has to say."""

from __future__ import annotations

from dataclasses import field

from febkit.model import Where
from febkit.record import value_record


@value_record
class Finding:
    """``severity``: "error" (FEBio or febkit would stop), "warning", "unsupported" (febkit cannot solve it),
    "hint"."""

    severity: str
    message: str
    where: Where = field(default_factory=Where)

    def __str__(self) -> str:
        place = f"{self.where}: " if str(self.where) else ""
        return f"{place}{self.severity}: {self.message}"

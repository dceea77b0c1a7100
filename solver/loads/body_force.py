"""Body force per mass, given in space and time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from ..points import Points
from ..values import as_value
from . import register
from .base import Floats, Number, Vector, as_vector, vector
from .body import BodyLoad, Group

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class BodyForce(BodyLoad):
    """a = -force. FEBio User Manual, "Body Force"."""

    given: Vector = (0.0, 0.0, 0.0)  # FEBio's <force>
    drives: ClassVar[bool] = True

    def __post_init__(self) -> None:
        self.given = as_vector(self.given)

    def force(self, pts: Points) -> Floats:
        """Acceleration (1|n, 3) at points; it drives the fluid of biphasic blocks too."""
        return -vector(self.given, pts.t, pts.X, pts.e)

    def acceleration(self, state: State, group: Group) -> Floats:
        pts = group.points()
        pts.t = state.time
        return self.force(pts)


@dataclass(eq=False)
class ComponentForce(BodyForce):
    """a = -(x, y, z): the body forces "const" and "non-const" of older files."""

    x: Number = 0.0
    y: Number = 0.0
    z: Number = 0.0

    def __post_init__(self) -> None:
        self.given = (as_value(self.x), as_value(self.y), as_value(self.z))


register(BodyForce, "body force")
register(ComponentForce, "const", "non-const")

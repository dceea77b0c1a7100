"""The model as an object: built, edited, looked at. :class:`febkit.Model` is the door; records stay frozen below it."""

from __future__ import annotations

from .completion import teach
from .model import Model

__all__ = ["Model"]

teach()

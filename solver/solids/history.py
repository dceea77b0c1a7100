"""Columns of history over a tree of materials: who owns which, and how they grow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..points import Points
from .base import Floats, Solid


def layout(root: Solid) -> int:
    """Give each record of the tree its first column; return the number of columns of all."""
    total = 0
    for node in root.walk():
        node.offset = total
        total += node.history
    return total


def widths(root: Solid) -> list[int]:
    """Columns of each record of the tree."""
    return [node.history for node in root.walk()]


def take_widths(root: Solid, columns: Sequence[int]) -> None:
    """Give each record as many columns, and lay them out."""
    for node, n in zip(root.walk(), columns, strict=True):
        if node.history != n:
            node.take_room(n)
    layout(root)


def initial(root: Solid, n: int) -> Floats:
    """State of ``n`` points before the first step (n, columns); lays out the columns."""
    out = np.empty((n, layout(root)))
    for node in root.walk():
        out[:, node.offset : node.offset + node.history] = node.initial(n)
    return out


def grows(root: Solid) -> bool:
    """Has the tree a record whose memory may grow?"""
    return any(type(node).room is not Solid.room for node in root.walk())


def begin(root: Solid, pts: Points) -> Floats:
    """The converged state ``pts.old`` with room for the coming step.

    Call once per step with all points of a block before its first evaluation; give every evaluation of
    the step the array returned as ``old``, and as ``new`` one that starts as a copy of it. Columns move when a
    record's memory grows.
    """
    old = pts.old
    if old is None:
        old = initial(root, pts.n)
        pts = pts.but(old=old)
    before = [(node, node.offset, node.history) for node in root.walk()]
    growing = [node for node, _, _ in before if type(node).room is not Solid.room]
    if not growing:
        return old
    for node in growing:
        node.room(pts)
    if all(node.history == h for node, _, h in before):
        return old
    wide = np.zeros((pts.n, layout(root)))
    for node, at, h in before:
        fresh = node.initial(pts.n)
        wide[:, node.offset : node.offset + node.history] = fresh
        wide[:, node.offset : node.offset + h] = old[:, at : at + h]
    return wide

"""The order in which the C++ library of GCC sorts, equal values included: FEBio takes the first of a sorted list.

Introsort without its heapsort, which lists of equal values do not reach: Musser, Softw Pract Exper 27 (1997) 983.
"""

from __future__ import annotations

from collections.abc import Sequence

SHORT = 16  # of items, that insertion alone sorts


def introsorted(values: Sequence[float], descending: bool) -> list[int]:
    """Places of the values in their sorted order."""
    key = [-v for v in values] if descending else list(values)
    at = list(range(len(key)))

    def less(i: int, j: int) -> bool:
        return key[at[i]] < key[at[j]]

    def swap(i: int, j: int) -> None:
        at[i], at[j] = at[j], at[i]

    def middle_to(first: int, a: int, b: int, c: int) -> None:
        """Swap the median of three to ``first``."""
        if less(a, b):
            swap(first, b if less(b, c) else c if less(a, c) else a)
        else:
            swap(first, a if less(a, c) else c if less(b, c) else b)

    def parted(first: int, last: int) -> int:
        """Swap items about the pivot before ``first``; where its upper side begins."""
        pivot = first - 1
        while True:
            while less(first, pivot):
                first += 1
            last -= 1
            while less(pivot, last):
                last -= 1
            if not first < last:
                return first
            swap(first, last)
            first += 1

    ahead = [(0, len(at))]
    while ahead:
        first, last = ahead.pop()
        while last - first > SHORT:
            middle_to(first, first + 1, first + (last - first) // 2, last - 1)
            cut = parted(first + 1, last)
            ahead.append((cut, last))
            last = cut
    return sorted(at, key=lambda i: key[i])  # by insertion, which leaves equal values as they are

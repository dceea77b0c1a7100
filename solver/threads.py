"""Element loops on a pool of threads. Kernels release the GIL, so plain threads suffice."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, TypeVar

import numpy as np

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor

T = TypeVar("T")


def available() -> int:
    """Processors this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


class Team:
    """``n`` threads, the caller's one among them; the others start with the first work for them."""

    def __init__(self, n: int = 0) -> None:
        self.n = n or available()
        self._pool: ThreadPoolExecutor | None = None

    def map(self, work: Callable[[int], T], k: int) -> list[T]:
        """``[work(0), ..., work(k - 1)]``, item 0 on the calling thread.

        All end before this returns or raises the failure of the lowest item.
        """
        if k == 1 or self.n == 1:
            return [work(i) for i in range(k)]
        from concurrent.futures import ThreadPoolExecutor, wait  # nothing a small scene should pay for

        if self._pool is None:
            self._pool = ThreadPoolExecutor(self.n - 1, "febkit", partial(np.seterr, **np.geterr()))
        later = [self._pool.submit(work, i) for i in range(1, k)]
        try:
            first = work(0)
        finally:
            wait(later)
        return [first, *[f.result() for f in later]]

    def close(self) -> None:
        if self._pool is not None:
            self._pool.shutdown()

"""Options of a run: keyword-only, and refused in words where they mean nothing."""

from __future__ import annotations

from typing import Any

import pytest

from febkit.solver.options import Options


@pytest.mark.parametrize(("given", "words"), [
    ({"threads": -1}, "threads must be 0 .* not -1"), ({"threads": 1.5}, "threads must be"),
    ({"threads": True}, "threads must be"),
    ({"linear": "lu"}, "linear must be one of auto, pardiso, .* not 'lu'"),
    ({"factor": "keep"}, "factor must be one of auto, fresh, reuse, not 'keep'"),
    ({"accuracy": -0.1}, "accuracy must be a number from 0"), ({"accuracy": 1e10}, "accuracy"),
    ({"accuracy": float("nan")}, "accuracy"), ({"memory": float("inf")}, "memory"), ({"stabilise": "yes"}, "stabilise"),
])  # fmt: skip
def test_what_is_no_option_is_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Options(**given)


def test_by_keyword_alone() -> None:
    with pytest.raises(TypeError):
        Options(1)  # type: ignore[misc]
    assert Options(threads=2, linear="dense", accuracy=1e-3).accuracy == 1e-3

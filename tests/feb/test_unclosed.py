"""Reading takes time in proportion to the file, also where lists are opened and never closed."""

from __future__ import annotations

import time

import pytest

from febkit.feb.document import _cut

LISTS = {
    "open": (b"<Nodes>", b""),
    "one end": (b"<Nodes>", b"</Nodes>"),
    "rows": (b'<Nodes><node id="1">1,2,3</node>', b"</Nodes>"),
    "two names": (b"<Nodes><Elements>", b""),
    "quotes": (b'<Nodes a="', b""),
    "comments": (b"<!--", b""),
}


@pytest.mark.parametrize("name", LISTS)
def test_unclosed_lists(name: str) -> None:
    piece, end = LISTS[name]
    start = time.process_time()
    _cut(piece * 40_000 + end)
    assert time.process_time() - start < 2.0

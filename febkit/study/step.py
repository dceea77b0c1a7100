"""A step of a study: what it does, to what, and the address that follows from both."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

# kind -> version; raise it when a step of this kind gives other results for the same input
VERSIONS: Mapping[str, int] = {
    "build": 1,
    "adopt": 1,
    "solve": 1,
    "series": 2,
    "drive": 2,
    "measure": 2,
    "compare": 3,
    "sample": 1,
    "background": 1,
}


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """``label`` is for people; the address ``key`` depends on kind, version, parameters and inputs alone.

    ``drop`` lists inputs whose files may go once this step is done; ``files`` says where files known by
    their content lie today.
    """

    kind: str
    label: str
    params: Mapping[str, Any]
    inputs: Mapping[str, Step] = field(default_factory=dict)
    drop: tuple[str, ...] = ()
    files: Mapping[str, str] = field(default_factory=dict)
    key: str = field(init=False)

    def __post_init__(self) -> None:
        what = {
            "kind": self.kind,
            "version": VERSIONS[self.kind],
            "febkit": _febkit(),
            "params": dict(self.params),
            "inputs": {k: s.key for k, s in self.inputs.items()},
        }
        text = json.dumps(what, sort_keys=True)
        object.__setattr__(self, "key", hashlib.sha256(text.encode()).hexdigest()[:32])

    def spec(self) -> dict[str, Any]:
        """What a worker needs to do this step: plain data, inputs by their addresses."""
        return {
            "kind": self.kind,
            "label": self.label,
            "key": self.key,
            "params": dict(self.params),
            "inputs": {k: s.key for k, s in self.inputs.items()},
            "drop": [self.inputs[n].key for n in self.drop],
            "files": dict(self.files),
        }

    def walk(self) -> Iterator[Step]:
        """This step and all it rests on, inputs first; one may come more than once."""
        for s in self.inputs.values():
            yield from s.walk()
        yield self


@lru_cache(maxsize=1)
def _febkit() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("febkit")
    except PackageNotFoundError:
        return "source"

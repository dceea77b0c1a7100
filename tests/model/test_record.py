"""Records: what a frozen dataclass does, with methods that all of them share."""

from __future__ import annotations

import copy
import pickle
from dataclasses import FrozenInstanceError, dataclass, field, fields, replace
from typing import ClassVar

import numpy as np
import pytest

from febkit.record import record, value_record, variable_record


@value_record
class Place:
    file: str
    line: int = 0
    notes: list[str] = field(default_factory=list)


@value_record
class Pair:
    file: str
    line: int


@record
class Cloud:
    X: np.ndarray


@variable_record
class Part:
    kinds: ClassVar[tuple[str, ...]] = ("solid",)
    name: str
    size: float = 1.0
    seen: list[str] = field(default_factory=list, init=False)
    columns: int = field(default=1, init=False, repr=False)

    def __post_init__(self) -> None:
        self.seen.append(self.name)


@variable_record
class Wide(Part):
    width: float = 2.0
    shade: float = field(default=0.0, kw_only=True)


@dataclass(eq=False)
class Deep(Part):
    depth: float = 3.0


@variable_record
class Mixed:
    more: float = 6.0
    columns = 7


@value_record
class Known:
    size: int = 2
    twice: int = field(default=4, init=False)


@variable_record
class Both(Mixed, Part):
    name: str = "both"


def test_fields_come_by_order_name_and_default() -> None:
    p, q = Place("a.feb", 3), Place(line=3, file="a.feb")
    assert (p.file, p.line, p.notes) == ("a.feb", 3, []) and p == q
    assert p.notes is not q.notes
    assert [f.name for f in fields(p)] == ["file", "line", "notes"]
    assert replace(p, line=4) == Place("a.feb", 4) != p
    assert repr(p) == "Place(file='a.feb', line=3, notes=[])"


@pytest.mark.parametrize(
    ("args", "given", "said"),
    [((), {}, "lacks file"), (("a", 1, [], 2), {}, "3 fields, not 4"), (("a",), {"file": "b"}, "file twice"),
     (("a",), {"lines": 3}, "no lines")],
)  # fmt: skip
def test_wrong_arguments_are_named(args: tuple[object, ...], given: dict[str, object], said: str) -> None:
    with pytest.raises(TypeError, match=said):
        Place(*args, **given)  # type: ignore[arg-type]


def test_nothing_changes_or_is_added() -> None:
    p = Place("a.feb")
    with pytest.raises(FrozenInstanceError):
        p.line = 4  # type: ignore[misc]
    with pytest.raises(FrozenInstanceError):
        p.other = 4  # type: ignore[attr-defined]
    with pytest.raises(FrozenInstanceError):
        del p.line


def test_equal_by_value_or_by_identity() -> None:
    assert hash(Pair("a", 1)) == hash(Pair("a", 1)) and Pair("a", 1) != Pair("a", 2)
    assert Place("a") != ("a", 0, [])
    one, other = Cloud(np.zeros(3)), Cloud(np.zeros(3))
    assert one == one and one != other and len({one, other}) == 2


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda p: pickle.loads(pickle.dumps(p))])
def test_copies_and_pickles(again: object) -> None:
    p = Place("a.feb", 3, ["x"])
    q = again(p)  # type: ignore[operator]
    assert q == p and q is not p


@pytest.mark.parametrize("kind", [Part, Wide, Deep, Both])
def test_a_record_that_changes(kind: type[Part]) -> None:
    p = kind(name="a", size=3.0)
    assert (p.name, p.size, p.seen) == ("a", 3.0, ["a"]) and p != kind(name="a", size=3.0) and Part.kinds == ("solid",)
    p.size = 4.0
    q = replace(p, name="b")
    assert (type(q), q.name, q.size, q.seen) == (kind, "b", 4.0, ["b"])
    assert pickle.loads(pickle.dumps(p)).__dict__ == p.__dict__
    with pytest.raises(TypeError, match="seen"):
        kind(name="a", seen=[])  # type: ignore[call-arg]


def test_fields_of_a_record_that_inherits() -> None:
    w = Wide("a", width=5.0)
    assert repr(w) == "Wide(name='a', size=1.0, seen=['a'], width=5.0, shade=0.0)"
    with pytest.raises(TypeError, match="3 fields, not 4"):
        Wide("a", 2.0, 3.0, 4.0)  # type: ignore[misc]
    assert (w.size, Deep("a", depth=4.0).depth, Wide("a", 2.0, 3.0).width) == (1.0, 4.0, 3.0)


def test_what_is_not_given_is_the_default_or_what_a_class_has_in_its_place() -> None:
    assert (Part("a").columns, Both().columns, Known(3).twice) == (1, 7, 4)
    with pytest.raises(TypeError, match="twice"):
        Known(twice=5)  # type: ignore[call-arg]

"""Small changes to trees of tags that the version steps share."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from .document import Tag

RTOL = 1e-12
_TRUTH = {"true": "1", "false": "0"}
TRUE = ("1", "true", "yes", "on")


def leaf(name: str, text: object = "", /, **attrs: str) -> Tag:
    return Tag(name, attrs, str(text))


def clone(tag: Tag) -> Tag:
    """A deep copy that may be edited; tables of numbers are shared."""
    out = Tag(tag.name, dict(tag.attrs), tag.text, [clone(c) for c in tag.children], tag.line, tag.doc)
    out.table = tag.table
    return out


def take(tag: Tag, name: str) -> Tag | None:
    """Takes the last child of this name out (and drops earlier ones, which it overrides)."""
    found = None
    for c in tag.all(name):
        found = c
        tag.children.remove(c)
    return found


def text(tag: Tag, name: str, default: str = "") -> str:
    c = tag.child(name)
    return default if c is None else c.text.strip()


def pop(tag: Tag, attr: str, default: str = "") -> str:
    return tag.attrs.pop(attr, default)


def rename(tag: Tag, attr: str, new: str) -> None:
    """Renames an attribute in its place."""
    if attr in tag.attrs:
        tag.attrs = {(new if k == attr else k): v for k, v in tag.attrs.items()}


def set_child(tag: Tag, name: str, value: str) -> None:
    c = tag.child(name)
    if c is None:
        tag.children.append(leaf(name, value))
    else:
        c.text = value


def is_true(value: str) -> bool:
    return value.strip().lower() in TRUE


def section(root: Tag, name: str, after: Iterable[str] = ()) -> Tag:
    """The section of this name, made if there is none (behind the last of ``after``)."""
    found = root.child(name)
    if found is not None:
        return found
    new = Tag(name, line=root.line, doc=root.doc)
    places = [i for i, c in enumerate(root.children) if c.name in tuple(after)]
    root.children.insert(places[-1] + 1 if places else len(root.children), new)
    return new


def drop_empty(root: Tag, names: Iterable[str]) -> None:
    names = tuple(names)
    root.children = [c for c in root.children if not (c.name in names and c.empty)]


def stages(root: Tag) -> Iterator[Tag]:
    """The root and, after it, every step: the tags that hold Control, Boundary, Loads, ..."""
    yield root
    for s in root.all("Step"):
        steps = s.all("step")
        if steps:
            yield from steps
        elif s.children:
            yield s


def materials(root: Tag) -> dict[str, str]:
    """Material names by id."""
    out = {}
    for s in root.all("Material"):
        for i, m in enumerate(s.all("material"), 1):
            number = m.get("id", str(i)) or str(i)
            out[number] = m.get("name") or f"Material{number}"
    return out


def fresh(base: str, used: set[str]) -> str:
    """A name not yet used, which is then marked used."""
    name, n = base, 1
    while name in used:
        n += 1
        name = f"{base}_{n}"
    used.add(name)
    return name


def listed(tag: Tag) -> list[str]:
    """Ids of <n id=/>, <e id=/>, <node id=/>, ... below a set."""
    if tag.table is not None:
        return [str(i) for i in tag.table.labels.tolist()]
    return [c.need("id") for c in tag if c.name not in ("NodeSet", "node_list")]


def walk(tag: Tag) -> list[Tag]:
    """The tag and all below it."""
    out = [tag]
    for c in tag.children:
        out += walk(c)
    return out


def _words(text: str) -> list[str]:
    return text.replace(",", " ").split()


def same_text(a: str, b: str, rtol: float = RTOL) -> bool:
    """Equal as lists of numbers and words."""
    if a == b:
        return True
    x, y = _words(a), _words(b)
    return len(x) == len(y) and all(_same_word(p, q, rtol) for p, q in zip(x, y))


def _same_word(a: str, b: str, rtol: float) -> bool:
    if a == b or _TRUTH.get(a, a) == _TRUTH.get(b, b):
        return True
    try:
        x, y = float(a), float(b)
    except ValueError:
        return False
    return x == y or abs(x - y) <= rtol * max(abs(x), abs(y))

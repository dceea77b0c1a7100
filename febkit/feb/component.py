"""Tags to parameter trees and back."""

from __future__ import annotations

from febkit.model import Component, Where, values

from .document import Document, Tag

NOWHERE = Where()


def component(tag: Tag, doc: Document | None = None, above: Where = NOWHERE) -> Component:
    """The component a tag spells; ``doc`` remembers where each came from.

    ``above``: the place of the tag around it, which stands for that of a tag that a conversion has made.
    """
    where = tag.where if tag.doc is not None else above
    attrs = dict(tag.attrs)
    type_, name, label = attrs.pop("type", None), attrs.pop("name", None), attrs.pop("id", None)
    number: int | None = None
    if label is not None:
        number = values.label(label, f"id= of <{tag.name}>", where)
    if tag.table is not None:
        children = tuple(rows(tag))
    else:
        children = tuple(component(c, doc, where) for c in tag.children)
    out = Component(tag.name, type_, name, number, tag.text.strip(), attrs, children, where)
    if doc is not None:
        doc.origin[id(out)] = tag
    return out


def rows(tag: Tag) -> list[Component]:
    """A list that was read as numbers, row by row."""
    t = tag.table
    assert t is not None
    out = []
    for label, row in zip(t.labels.tolist(), t.values.tolist()):
        text = ",".join(f"{v:.17g}" for v in row)
        if t.attr == "id":
            out.append(Component(t.tag, id=label, text=text, where=tag.where))
        else:
            out.append(Component(t.tag, text=text, attrs={t.attr: str(label)}, where=tag.where))
    return out


def tag_of(c: Component) -> Tag:
    """The tag that spells a component."""
    attrs: dict[str, str] = {}
    if c.id is not None:
        attrs["id"] = str(c.id)
    if c.name is not None:
        attrs["name"] = c.name
    if c.type is not None:
        attrs["type"] = c.type
    attrs |= c.attrs
    return Tag(c.tag, attrs, c.text, [tag_of(x) for x in c.children], c.where.line)

"""A tree of tags to text."""

from __future__ import annotations

import numpy as np

from .document import Tag
from .table import Table

HEADER = '<?xml version="1.0" encoding="UTF-8"?>\n'
CHUNK = 20_000  # rows formatted at once


def attributes(attrs: dict[str, str]) -> str:
    return "".join(f" {k}={_quoted(v)}" for k, v in attrs.items())


def escape(text: str) -> str:
    """Text between tags. (The standard library's way imports what opens web pages.)"""
    return text.replace("&", "&amp;").replace(">", "&gt;").replace("<", "&lt;")


def _quoted(v: str) -> str:
    if v.isalnum():
        return f'"{v}"'
    text = escape(v).replace("\n", "&#10;").replace("\t", "&#9;").replace("\r", "&#13;")
    if '"' not in text:
        return f'"{text}"'
    return f"'{text}'" if "'" not in text else '"' + text.replace('"', "&quot;") + '"'


def table_text(t: Table, indent: str) -> str:
    """Rows of a table, one a line; numbers in the fewest digits that read back the same."""
    columns = t.values.shape[1]
    spec = "%d" if np.issubdtype(t.values.dtype, np.integer) else "%r"
    row = f'{indent}<{t.tag} {t.attr}="%d">{",".join([spec] * columns)}</{t.tag}>\n'
    out = []
    for i in range(0, len(t.labels), CHUNK):
        labels, values = t.labels[i:i + CHUNK].tolist(), t.values[i:i + CHUNK]
        n = len(labels)
        flat: list[float] = [0] * (n * (columns + 1))
        flat[:: columns + 1] = labels
        for c in range(columns):
            flat[c + 1:: columns + 1] = values[:, c].tolist()
        out.append((row * n) % tuple(flat))
    return "".join(out)


def tag_text(tag: Tag, indent: str = "") -> str:
    """A tag and all below it, tab-indented, with a line end."""
    pieces: list[str] = []
    _write(tag, indent, pieces)
    return "".join(pieces)


def _write(tag: Tag, indent: str, out: list[str]) -> None:
    head = f"{indent}<{tag.name}{attributes(tag.attrs)}"
    text = escape(tag.text).replace("\r", "&#13;") if tag.text else ""
    if tag.table is not None:
        out += [head, ">\n", table_text(tag.table, indent + "\t"), f"{indent}</{tag.name}>\n"]
    elif tag.children:
        out += [head, ">", text, "\n"]
        inner = indent + "\t"
        for c in tag.children:
            _write(c, inner, out)
        out.append(f"{indent}</{tag.name}>\n")
    elif text:
        out += [head, ">", text, f"</{tag.name}>\n"]
    else:
        out += [head, "/>\n"]


SAME = {"Geometry": "Mesh"}  # sections by their present name


def document_bytes(root: Tag, remarks: dict[str, list[str]] | None = None) -> bytes:
    """A whole file; ``remarks`` are comments to stand in front of sections, by section."""
    out = [HEADER]
    left = {SAME.get(k, k): list(v) for k, v in (remarks or {}).items()}
    out += [f"<!--{r}-->\n" for r in left.pop(root.name, [])]
    out.append(f"<{root.name}{attributes(root.attrs)}>\n")
    for c in root:
        out += [f"\t<!--{r}-->\n" for r in left.pop(SAME.get(c.name, c.name), [])]
        out.append(tag_text(c, "\t"))
    out += [f"\t<!--{r}-->\n" for rest in left.values() for r in rest]
    out.append(f"</{root.name}>\n")
    return "".join(out).encode()

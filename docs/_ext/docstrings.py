"""Docstrings of the house as reStructuredText: a line `name  what it is` becomes a definition."""

from __future__ import annotations

import re
from typing import Any

ENTRY = re.compile(r"^(\*{0,2}[\w:.,\[\]<> *]+?)\s{2,}(\S.*)$")  # a name, two spaces or more, what it is


def setup(app: Any) -> dict[str, bool]:
    app.connect("autodoc-process-docstring", renew)
    return {"parallel_read_safe": True}


def renew(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Paragraphs that list names become definition lists, lines that are indented without need are not."""
    out: list[str] = []
    for paragraph in paragraphs(lines):
        out += [*definitions(paragraph), ""]
    lines[:] = out


def paragraphs(lines: list[str]) -> list[list[str]]:
    found: list[list[str]] = [[]]
    for line in lines:
        if line.strip():
            found[-1].append(line.rstrip())
        elif found[-1]:
            found.append([])
    return [p for p in found if p]


def definitions(paragraph: list[str]) -> list[str]:
    """A paragraph whose first line is an entry, as a definition list; any other as one block of its own indent."""
    if paragraph[0].startswith((">>>", "- ", "* ", "    ")) or paragraph[0].endswith("::"):
        return paragraph
    if not ENTRY.match(paragraph[0]):
        return flush(paragraph)
    out: list[str] = []
    for line in paragraph:
        entry = ENTRY.match(line) if not line.startswith(" ") else None
        if entry:
            out += [entry[1].strip(), f"    {entry[2]}"]
        else:
            out.append(f"    {line.strip()}")
    return out


def flush(paragraph: list[str]) -> list[str]:
    """Text whose lines begin at one column, but for an equation or a list below a line of text."""
    least = min(len(s) - len(s.lstrip()) for s in paragraph[1:]) if paragraph[1:] else 0
    if not least or paragraph[0].startswith(" "):
        return paragraph
    return [s.strip() for s in paragraph]

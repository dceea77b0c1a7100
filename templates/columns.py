"""Two columns of a CSV file: depths, and the values of one property."""

from __future__ import annotations

import re
from pathlib import Path

from febkit.model import InputError, Where
from febkit.model.values import spells_number

_SPLIT = re.compile(r"\s*[,;]\s*|\s+")


def columns(path: Path, name: str, column: str | None, named_by: Where | None) -> tuple[list[list[float]], list[int]]:
    """Rows [depth, value] of a file and the lines that they stand on.

    Separated by commas, semicolons or blanks; lines that begin with # and empty ones are passed over. With a line of
    names first, depths are those under "depth" (else of the first column), values those under ``column``, else under
    ``name``, else of the only other column.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as e:
        why = e.strerror if isinstance(e, OSError) else "it is no text in UTF-8"
        raise InputError(f"{name}: cannot read {path}: {why}; paths are relative to the file that names them (to "
                         "the current folder with --set)", named_by) from None
    rows = [(k, _SPLIT.split(line.strip())) for k, line in enumerate(text.splitlines(), 1)
            if line.strip() and not line.lstrip().startswith("#")]
    if not rows:
        raise InputError(f"{name}: the file has no rows of depths and values", Where(str(path)))
    names = [] if spells_number(rows[0][1][0]) else [w.strip('"') for w in rows.pop(0)[1]]
    depth, value = _places(names, len(rows[0][1]) if rows else 0, name, column, path)
    out = []
    for line, cells in rows:
        if len(cells) <= max(depth, value):
            raise InputError(f"{name}: this row has {len(cells)} numbers, column {max(depth, value) + 1} is missing",
                             Where(str(path), line))
        out.append([_value(cells[i], Where(str(path), line), name) for i in (depth, value)])
    if not out:
        raise InputError(f"{name}: the file has names of columns and no rows", Where(str(path)))
    return out, [k for k, _ in rows]


def _places(names: list[str], width: int, name: str, column: str | None, path: Path) -> tuple[int, int]:
    """Numbers of the columns of depths and of values."""
    where = Where(str(path))
    lower = [n.lower() for n in names]
    depth = lower.index("depth") if "depth" in lower else 0
    for wanted in (column, name) if column is None else (column,):
        if wanted is not None and wanted in names:
            return depth, names.index(wanted)
    count = len(names) or width
    if column is None and count == 2:
        return depth, 1 - depth
    said = f"its columns are {', '.join(names)}" if names else f"it has {count} columns without names"
    raise InputError(f"{name}: the file has no column '{column or name}'; {said}: name one with {{file = "
                     f"\"{path.name}\", column = \"...\"}}", where)


def _value(text: str, where: Where, name: str) -> float:
    if not spells_number(text):
        raise InputError(f"{name}: '{text}' is no number", where)
    return float(text)

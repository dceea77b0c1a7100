"""Template files of models: a .feb without its <Mesh>, with places, conditions and repetitions.

    <bc if="case in ('A', 'B')" type="prescribed displacement" node_set="top"> ... ${-depth} ... </bc>
    <SolidDomain for="name, role in parts" name="${name}" mat="${role}"/>

``${expression}`` stands for a value, ``if`` drops an element, ``for`` repeats it, ``from`` fills it with a table
(:mod:`.materials`). An attribute whose value comes out empty is left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from febkit.model import InputError, Mesh, Model, NodeSet, Where

from .expression import evaluate, fill, written


def instantiate(path: Path, names: Mapping[str, Any], mesh: Mesh) -> Model:
    """The model of a template file with its values filled in, on a mesh."""
    from febkit.feb import read_bytes

    data = expand(path, names)
    model = read_bytes(data, str(path))
    return replace(model, mesh=_with_all(mesh, model), document=None, file="")


def _with_all(mesh: Mesh, model: Model) -> Mesh:
    """The mesh with a node set "all", where the model refers to one."""
    given = [c for s in (model.common, *model.steps) for c in (*s.initial, *s.boundary)]
    if not any(c.attrs.get("node_set") == "all" for c in given) or "all" in mesh.node_sets:
        return mesh
    return replace(mesh, node_sets={**mesh.node_sets, "all": NodeSet("all", np.arange(len(mesh.X)))})


def expand(path: Path, names: Mapping[str, Any]) -> bytes:
    """The XML of a template file with its values filled in."""
    from lxml import etree

    try:
        tree = etree.parse(str(path), etree.XMLParser(remove_comments=True))
    except OSError:
        raise InputError("cannot open the template's model file", Where(str(path))) from None
    except etree.XMLSyntaxError as e:
        raise InputError(f"not well-formed XML: {e.msg}", Where(str(path), e.lineno or 0)) from None
    root = tree.getroot()
    _expand_children(root, dict(names), str(path))
    for section in root.iterfind("Material"):  # FEBio wants them by their ids, whichever of the file's lines made them
        section[:] = sorted(section, key=lambda m: int(m.get("id", 0)))
    data: bytes = etree.tostring(root, xml_declaration=True, encoding="UTF-8")
    return data


def _expand_children(parent: Any, names: dict[str, Any], file: str) -> None:
    where = Where(file, parent.sourceline or 0)
    for key, text in list(parent.attrib.items()):
        parent.attrib[key] = fill(text, names, where)
        if not parent.attrib[key] and text:
            del parent.attrib[key]
    if parent.text:
        parent.text = fill(parent.text, names, where)
    for child in list(parent):
        copies = list(_copies(child, names, file))
        at = parent.index(child)
        parent.remove(child)
        for offset, (copy, local) in enumerate(copies):
            parent.insert(at + offset, copy)
            _expand_children(copy, local, file)


def _copies(child: Any, names: dict[str, Any], file: str) -> Iterator[tuple[Any, dict[str, Any]]]:
    """An element as often as its ``for`` says, where its ``if`` holds."""
    from copy import deepcopy

    where = Where(file, child.sourceline or 0)
    loop, condition, table = (child.attrib.pop(k, None) for k in ("for", "if", "from"))
    if loop is None:
        rounds: list[dict[str, Any]] = [{}]
    else:
        variables, found, source = loop.partition(" in ")
        if not found:
            raise InputError(f'for="{loop}" must read for="name in list"', where)
        keys = [v.strip() for v in variables.split(",")]
        items = evaluate(source, names, where)
        rounds = [dict(zip(keys, v if len(keys) > 1 else [v], strict=True)) for v in items]
    for more in rounds:
        local = names | more
        if condition is None or evaluate(condition, local, where):
            copy = deepcopy(child)
            if table is not None:
                _put(copy, evaluate(table, local, where))
            yield copy, local


def _put(element: Any, table: Mapping[str, Any]) -> None:
    """Write a table into an element of lxml."""
    from lxml import etree

    for key, value in table.items():
        if key == "type" or key.startswith("@"):
            element.set(key.removeprefix("@"), written(value))
        elif key == "text":
            element.text = written(value)
        else:
            several = value if isinstance(value, list) and any(isinstance(v, dict | str) for v in value) else [value]
            for item in several:
                try:
                    child = etree.SubElement(element, key)
                except ValueError:
                    raise InputError(f"'{key}' cannot be a tag of a material") from None
                if isinstance(item, Mapping):
                    _put(child, item)
                else:
                    child.text = written(item)

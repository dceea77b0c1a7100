"""What meshio reads .feb and .xplt and writes .feb with.

>>> import meshio                                           # doctest: +SKIP
>>> meshio.read("m.feb"), meshio.read("m.xplt")             # doctest: +SKIP
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import meshio
import numpy as np

from febkit.model import (
    Component,
    Domain,
    ElementBlock,
    ElementSet,
    InputError,
    Mesh,
    Model,
    NodeSet,
    Output,
    PlotVariable,
    Step,
    Surface,
    Where,
    as_record,
)
from febkit.model.elements import domain
from febkit.results.cells import FACETS, FEBIO, INVERSE, KEPT, LINES, MESHIO, ORDER, SOLIDS

Path_ = str | os.PathLike[str]


def read_feb(path: Path_) -> meshio.Mesh:
    """Mesh and sets of an input file."""
    from febkit.feb import read

    return from_model(read(path))


def from_model(model: Model) -> meshio.Mesh:
    """A model's mesh: a cell block per element block, named by a cell set; node, element sets; ids.

    Surfaces become blocks of facets with a cell set of their name.
    """
    m = as_record(model).mesh
    blocks: list[tuple[str, np.ndarray]] = []
    ids: list[np.ndarray] = []
    parts: list[np.ndarray] = []
    owners: list[str] = []  # set that a whole block belongs to
    for i, b in enumerate(m.blocks):
        blocks.append(_cells(b.type, b.conn))
        ids.append(np.asarray(b.ids))
        parts.append(np.full(len(b.ids), i))
        owners.append(b.name)
    element_ids = [set(a.tolist()) for a in ids]
    for s in m.surfaces.values():
        for type_, conn in s.facets.items():
            blocks.append(_cells(type_, np.asarray(conn)))
            ids.append(np.zeros(len(conn), np.int64))
            parts.append(np.full(len(conn), -1))
            owners.append(s.name)
    sets = {name: [np.arange(len(c)) if o == name else _none() for (_, c), o in zip(blocks, owners)]
            for name in dict.fromkeys(owners)}
    for e in m.element_sets.values():
        wanted = np.asarray(e.elements)
        sets[e.name] = [
            np.flatnonzero(np.isin(a, wanted)) if k < len(m.blocks) and element_ids[k] & set(wanted.tolist())
            else _none()
            for k, a in enumerate(ids)
        ]
    return meshio.Mesh(
        np.asarray(m.X),
        blocks,
        point_data={"node_id": np.asarray(m.node_ids)},
        cell_data={"element_id": ids, "part": parts},
        point_sets={n.name: np.asarray(n.nodes) for n in m.node_sets.values()},
        cell_sets=sets,
    )


def _none() -> np.ndarray:
    return np.empty(0, np.int64)


def _cells(type_: str, conn: np.ndarray) -> tuple[str, np.ndarray]:
    if type_ not in MESHIO:
        raise InputError(f"meshio has no cells like FEBio's {type_}")
    conn = conn[:, : KEPT.get(type_, conn.shape[1])]
    order = ORDER.get(type_)
    return MESHIO[type_], conn[:, order] if order else conn


def read_xplt(path: Path_) -> meshio.Mesh:
    """The last state of a plotfile: reference coordinates, nodal and element data, node sets."""
    from febkit import results
    from febkit.results.mesh import of
    from febkit.results.vtk import Plan, cells

    ds = results.open_all(path)[-1]
    if ds.sizes["time"]:
        mesh = Plan(ds, None, False).state(ds.sizes["time"] - 1)[0]
    else:
        mesh = meshio.Mesh(ds["X"].values, cells(ds)[0])
    mesh.point_sets = {k: np.asarray(v) for k, v in of(ds).node_sets.items()}
    return mesh


def to_model(mesh: meshio.Mesh, file: str = "") -> Model:
    """A model of a mesh: blocks, sets, and a stub of a material to fill in.

    Cells of the highest dimension become element blocks, one per type and cell set (or physical group);
    cells of one dimension less become surfaces, named by their set. Point sets become node sets.
    """
    groups = _groups(mesh, file)
    solids = [g for g in groups if g.type in SOLIDS]
    elements = solids or [g for g in groups if g.type in FACETS] or [g for g in groups if g.type in LINES]
    if not elements:
        raise InputError("the mesh has no cells that FEBio knows", Where(file))
    X = np.zeros((len(mesh.points), 3))
    X[:, : mesh.points.shape[1]] = mesh.points
    keep = np.unique(np.concatenate([g.conn.ravel() for g in elements]))
    at = np.full(len(X), -1)
    at[keep] = np.arange(len(keep))  # points that no element uses would leave FEBio a singular matrix
    blocks, first = [], 1
    names = [g.name for g in elements]
    for g in elements:
        name = g.name if names.count(g.name) == 1 else f"{g.name}_{g.type}"
        ids = np.arange(first, first + len(g.conn))
        blocks.append(ElementBlock(name, g.type, ids, at[g.conn]))
        first += len(ids)
    faces = [g for g in groups if solids and g.type in FACETS and (at[g.conn] >= 0).all()]
    node_sets = {n: NodeSet(n, _kept(at, nodes)) for n, nodes in _point_sets(mesh).items()}
    return Model(
        version="4.0",
        module="solid",
        mesh=Mesh(
            node_ids=np.arange(1, len(keep) + 1),
            X=X[keep],
            blocks=tuple(blocks),
            node_sets={n: s for n, s in node_sets.items() if len(s.nodes)},
            surfaces=_surfaces(faces, at),
            element_sets=_element_sets(mesh, elements, blocks),
        ),
        materials=(stub("material1", 1),),
        domains=tuple(Domain(b.name, domain(b.type), "material1") for b in blocks),
        steps=(Step(control=control_stub()),),
        output=Output(plot=(PlotVariable("displacement"), PlotVariable("stress"))),
        file=file,
    )


def stub(name: str, number: int) -> Component:
    """A neo-Hookean material to be replaced: E = 1, v = 0.3, density 1 in the model's units."""
    values = (("density", "1"), ("E", "1"), ("v", "0.3"))
    children = tuple(Component(tag, text=text) for tag, text in values)
    return Component("material", "neo-Hookean", name, number, children=children)


def control_stub() -> Component:
    """A static step of ten equal parts of a unit of time."""
    values = (("analysis", "STATIC"), ("time_steps", "10"), ("step_size", "0.1"))
    return Component("Control", children=tuple(Component(tag, text=text) for tag, text in values))


def _kept(at: np.ndarray, nodes: Any) -> np.ndarray:
    new = at[np.asarray(nodes, np.int64)]
    return np.asarray(new[new >= 0])


class _Group:
    """Cells of one type and one name, from one or several of meshio's blocks."""

    def __init__(self, name: str, type_: str) -> None:
        self.name, self.type = name, type_
        self.parts: list[tuple[int, np.ndarray]] = []  # (block, its rows)
        self._conn: list[np.ndarray] = []

    def add(self, block: int, rows: np.ndarray, conn: np.ndarray) -> None:
        order = INVERSE.get(self.type)
        self.parts.append((block, rows))
        self._conn.append(conn[:, order] if order else conn)

    @property
    def conn(self) -> np.ndarray:
        return np.concatenate(self._conn)


def _groups(mesh: meshio.Mesh, file: str) -> list[_Group]:
    """Cells by name (cell set, physical group or "part<i>") and type."""
    out: dict[tuple[str, str], _Group] = {}
    for i, cells in enumerate(mesh.cells):
        if cells.type in ("vertex", "polygon", "polyhedron") or not len(cells.data):
            continue
        if cells.type not in FEBIO:
            raise InputError(f"FEBio has no elements like meshio's {cells.type}", Where(file))
        type_, data = FEBIO[cells.type], np.asarray(cells.data)
        for name, rows in _division(mesh, i):
            out.setdefault((name, type_), _Group(name, type_)).add(i, rows, data[rows])
    return list(out.values())


def _division(mesh: meshio.Mesh, i: int) -> list[tuple[str, np.ndarray]]:
    """(name, rows) of a block: whole, or parted by sets that do not overlap, or by gmsh:physical."""
    n = len(mesh.cells[i].data)
    named = []
    for key, parts in mesh.cell_sets.items():
        rows = parts[i] if i < len(parts) else None
        if rows is not None and len(rows) and not str(key).startswith("gmsh:"):
            named.append((str(key), np.asarray(rows, np.int64)))
    if named:
        together = np.concatenate([r for _, r in named])
        if len(together) == n and len(np.unique(together)) == n:
            return named
    tags = mesh.cell_data.get("gmsh:physical", mesh.cell_data.get("medit:ref"))
    if tags is None:
        covering = [k for k, r in named if len(np.unique(r)) == n]
        return [(covering[0] if covering else f"part{i + 1}", np.arange(n))]
    names = {(int(v[0]), int(v[1])): str(k) for k, v in mesh.field_data.items() if len(v) == 2}
    dim, values = _dimension(FEBIO[mesh.cells[i].type]), np.asarray(tags[i])
    return [(names.get((int(v), dim), f"part{v}"), np.flatnonzero(values == v)) for v in np.unique(values)]


def _dimension(type_: str) -> int:
    return 3 if type_ in SOLIDS else 2 if type_ in FACETS else 1


def _point_sets(mesh: meshio.Mesh) -> dict[str, np.ndarray]:
    return {str(k): np.asarray(v, np.int64).ravel() for k, v in mesh.point_sets.items()}


def _surfaces(groups: Sequence[_Group], at: np.ndarray) -> dict[str, Surface]:
    """Facets of one name, of all types, as one surface."""
    facets: dict[str, dict[str, list[np.ndarray]]] = {}
    for g in groups:
        facets.setdefault(g.name, {}).setdefault(g.type, []).append(at[g.conn])
    return {n: Surface(n, {t: np.concatenate(c) for t, c in by.items()}) for n, by in facets.items()}


def _element_sets(
    mesh: meshio.Mesh, groups: Sequence[_Group], blocks: Sequence[ElementBlock]
) -> dict[str, ElementSet]:
    """Cell sets that are not blocks themselves, as ids."""
    out: dict[str, ElementSet] = {}
    names = {b.name for b in blocks}
    for name, parts in mesh.cell_sets.items():
        key = str(name)
        if key in names or key.startswith("gmsh:"):
            continue
        found = []
        for g, b in zip(groups, blocks):
            wanted = [parts[i] if i < len(parts) and parts[i] is not None else _none() for i, _ in g.parts]
            inside = [np.isin(rows, np.asarray(w, np.int64)) for (_, rows), w in zip(g.parts, wanted)]
            found.append(b.ids[np.concatenate(inside)])
        ids = np.concatenate(found) if found else _none()
        if len(ids):
            out[key] = ElementSet(key, ids)
    return out


def write_feb(path: Path_, mesh: meshio.Mesh, **_: Any) -> None:
    """A mesh as an input file (4.0) with its sets and a stub of a material."""
    from febkit.feb import write

    write(to_model(mesh, str(path)), path)


def read_mesh(path: Path_) -> meshio.Mesh:
    """Any file that meshio reads; a clear error instead of meshio's exit."""
    _known(path, "reads")
    heard: list[str] = []
    try:
        with _listening(heard):
            return meshio.read(path)
    except (InputError, OSError):
        raise
    except (Exception, SystemExit) as e:
        said = "; ".join(heard) if isinstance(e, SystemExit) else str(e).strip() or type(e).__name__
        raise InputError(f"meshio cannot read it as {Path(path).suffix}: {said}", Where(str(Path(path)))) from None


def write_mesh(mesh: meshio.Mesh, path: Path_, overwrite: bool = True) -> list[str]:
    """Write a mesh in a format of meshio's; what meshio said of it.

    Raises InputError, and writes nothing, where the format cannot hold every cell (what was written is read again)
    or where a file exists and ``overwrite`` is False.
    """
    from febkit.files import may_write, real

    path = real(path)
    may_write(path, overwrite)
    _known(path, "writes")
    before = sum(len(c.data) for c in mesh.cells)
    if not before:
        raise InputError("there are no cells to write", Where(str(path)))
    heard: list[str] = []
    with TemporaryDirectory(dir=path.parent, prefix=".febkit-") as folder:
        made = Path(folder) / path.name  # some formats have companions that are named in the file
        try:
            with _listening(heard):
                mesh.write(made)
        except OSError:
            raise
        except (Exception, SystemExit) as e:
            said = "; ".join(heard) if isinstance(e, SystemExit) else str(e).strip() or type(e).__name__
            raise InputError(f"meshio cannot write this mesh as {path.suffix}: {said}", Where(str(path))) from None
        after = sum(len(c.data) for c in read_mesh(made).cells)
        if after < before:
            kinds = ", ".join(dict.fromkeys(c.type for c in mesh.cells))
            raise InputError(f"{path.suffix} holds {after} of the mesh's {before} cells ({kinds}): take .vtu or .msh",
                             Where(str(path)))
        for f in Path(folder).iterdir():
            may_write(path.parent / f.name, overwrite)
        for f in Path(folder).iterdir():
            f.replace(path.parent / f.name)
    return heard


def _known(path: Path_, verb: str) -> None:
    """Raises InputError for an ending that meshio has no format for."""
    suffixes = [s.lower() for s in Path(path).suffixes]
    if not any("".join(suffixes[k:]) in meshio.extension_to_filetypes for k in range(len(suffixes))):
        ending = f'files that end in "{suffixes[-1]}"' if suffixes else "files without an ending"
        raise InputError(f"meshio {verb} no {ending}; it knows {', '.join(sorted(meshio.extension_to_filetypes))}",
                         Where(str(Path(path))))


@contextmanager
def _listening(heard: list[str]) -> Iterator[None]:
    """Collect what meshio prints, a line for each message, instead of having it printed."""
    out = StringIO()
    try:
        with redirect_stdout(out), redirect_stderr(out), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        for line in out.getvalue().splitlines():
            begins = line.startswith(("Info:", "Warning:", "Error:")) or not heard
            if begins and line.strip():
                heard.append(line.partition(": ")[2] if line.startswith(("Info:", "Warning:", "Error:")) else line)
            elif line.strip():
                heard[-1] += f" {line.strip()}"

"""Tetrahedra in what was segmented: an image of labels (.npy, .tif) or closed surfaces (.stl), one for each part.

Surfaces between labels are pyvista's surface nets, smoothed here; gmsh fills them, hybrid meshes up to layers of wedges
(:mod:`.wedges`). Both come with the extra
``febkit[tets]``; gmsh is GPL, and nothing but this module calls it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from febkit.model import InputError, Where
from febkit.model.mesh import Floats, Ints

from .elements import TET_EDGES
from .parts import Parts, without_loose_nodes
from .wedges import Region, layered

IMAGES = (".npy", ".tif", ".tiff")
Wedges = tuple[int, float] | None


def from_image(path: str | Path, voxel: Sequence[float], smoothing: int,
               wedges: Wedges = None) -> tuple[Floats, dict[tuple[int, str], Ints]]:
    """Nodes (node, 3) about the image's middle, and elements by label and type, of an image with 0 outside.

    ``voxel``: its edges along x, y, z. Arrays are [x, y, z], pages of a TIFF [z][y][x]. ``smoothing``: rounds that the
    surfaces are smoothed in. ``wedges``: layers around each cell, and their share of the way to the next surface.
    """
    import_extra("pyvista")
    where = Where(str(path))
    labels = _labels(Path(path), where)
    if len(voxel) != 3 or min(voxel) <= 0:
        raise InputError("set voxel to the edges of the image's voxels along x, y, z (in the model's unit)", where)
    import pyvista as pv

    shape = labels.shape
    image = pv.ImageData(dimensions=shape, spacing=tuple(voxel),
                         origin=tuple(-(n - 1) / 2.0 * h for n, h in zip(shape, voxel, strict=True)))
    image.point_data["label"] = labels.ravel(order="F")
    net = image.contour_labels(boundary_style="all", output_mesh_type="triangles", scalars="label",
                               simplify_output=False, smoothing=False)
    sides = np.sort(np.asarray(net.cell_data["boundary_labels"]), axis=1)
    pairs = np.unique(sides, axis=0)
    used, triangles = np.unique(np.asarray(net.faces).reshape(-1, 4)[:, 1:], return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    patches = [triangles[(sides == pair).all(axis=1)] for pair in pairs]
    numbers = [int(n) for n in np.unique(labels) if n != 0]
    regions = [Region(str(n), tuple(int(k) for k in np.flatnonzero((pairs == n).any(axis=1)))) for n in numbers]
    surface = smoothed(np.asarray(net.points, dtype=float)[used], triangles, smoothing)
    X, found = _filled(surface, patches, regions, wedges, where)
    return X, {(int(name), kind): conn for (name, kind), conn in found.items()}


def smoothed(X: Floats, triangles: Ints, rounds: int) -> Floats:
    """Nodes of triangles moved towards their neighbours' mean and back, so that steps go and volumes stay.

    Source: Taubin, G., 1995. A signal processing approach to fair surface design. Proc. SIGGRAPH, 351-358.
    """
    from scipy.sparse import coo_matrix

    a, b = triangles[:, [0, 1, 2]].ravel(), triangles[:, [1, 2, 0]].ravel()
    link = coo_matrix((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(len(X), len(X))).tocsr()
    count = np.asarray(link.sum(axis=1))
    for _ in range(rounds):
        for share in (0.5, -0.53):
            X = X + share * (link @ X / count - X)
    return X


def _labels(path: Path, where: Where) -> Ints:
    try:
        if path.suffix == ".npy":
            v = np.load(path)
        else:
            from PIL import Image, ImageSequence

            with Image.open(path) as pages:
                v = np.stack([np.array(page) for page in ImageSequence.Iterator(pages)]).transpose(2, 1, 0)
    except (OSError, ValueError) as e:
        raise InputError(f"cannot read the image: {e}", where) from None
    if v.ndim != 3 or min(v.shape) < 3 or not np.issubdtype(v.dtype, np.integer):
        raise InputError(f"an image of labels has whole numbers in three dimensions, not {v.dtype} of shape {v.shape}",
                         where)
    if (v == v.flat[0]).all():
        raise InputError(f"all voxels have the label {v.flat[0]}: there is no surface", where)
    return np.pad(v.astype(np.int64), 1)  # 0 around, so that all is closed


def from_surfaces(files: Mapping[str, str], scale: float, wedges: Wedges = None) -> Parts:
    """Elements in closed surfaces, by part; a part that has others in it is what lies between."""
    import meshio

    X: list[Floats] = []
    patches: list[Ints] = []
    first = 0
    for name, file in files.items():
        where = Where(str(file))
        try:
            m = meshio.read(file)
        except (OSError, meshio.ReadError, SystemExit, ValueError, KeyError) as e:
            raise InputError(f"meshio cannot read the surface of {name}: {e}", where) from None
        found = [b.data for b in m.cells if b.type == "triangle"]
        if not found:
            raise InputError(f"the surface of {name} has no triangles", where)
        points, number = _merged(np.asarray(m.points, dtype=float) * scale)
        triangles = number[np.concatenate(found)]
        _check_closed(triangles, name, where)
        X.append(points)
        patches.append(triangles + first)
        first += len(points)
    names, nodes = list(files), np.concatenate(X)
    outer = [_parent(nodes, patches, i) for i in range(len(names))]
    regions = [Region(n, (i, *(j for j, p in enumerate(outer) if p == i))) for i, n in enumerate(names)]
    filled, found_in = _filled(nodes, patches, regions, wedges, Where(", ".join(files.values())))
    several = {name for name, kind in found_in if kind != "tet4"}
    return without_loose_nodes(filled, {f"{name}_{kind}" if name in several else name: (kind, conn)
                                        for (name, kind), conn in found_in.items()})


def _merged(points: Floats) -> tuple[Floats, Ints]:
    """Points without doubles, as STL has them, and the number of each."""
    size = float(np.ptp(points, axis=0).max()) or 1.0
    _, first, number = np.unique(np.round(points / size, 9), axis=0, return_index=True, return_inverse=True)
    return points[first], number.ravel()


def _check_closed(triangles: Ints, name: str, where: Where) -> None:
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    if (count != 2).any():
        raise InputError(f"the surface of {name} is not closed: {(count != 2).sum()} edges do not join two triangles; "
                         "repair it first", where)


def _parent(X: Floats, patches: Sequence[Ints], i: int) -> int:
    """The smallest closed surface around another, -1 where there is none."""
    around = [j for j in range(len(patches)) if j != i and abs(_winding(X[patches[j]], X[patches[i][0, 0]])) > 0.5]
    return min(around, key=lambda j: abs(_volume(X[patches[j]])), default=-1)


def _winding(triangles: Floats, point: Floats) -> float:
    """How often closed triangles (n, 3, 3) go around a point: the sum of their solid angles over 4 pi.

    Source: van Oosterom, A., Strackee, J., 1983. The solid angle of a plane triangle. IEEE Trans. Biomed. Eng. 30, 125.
    """
    a, b, c = np.moveaxis(triangles - point, 1, 0)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    det = np.einsum("ni,ni->n", a, np.cross(b, c))
    dots = [np.einsum("ni,ni->n", u, v) for u, v in ((a, b), (b, c), (c, a))]
    return float(np.arctan2(det, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb).sum() / (2.0 * np.pi))


def _volume(triangles: Floats) -> float:
    a, b, c = np.moveaxis(triangles, 1, 0)
    return float(np.einsum("ni,ni->n", a, np.cross(b, c)).sum() / 6.0)


def _filled(X: Floats, patches: Sequence[Ints], regions: Sequence[Region], wedges: Wedges,
            where: Where) -> tuple[Floats, dict[tuple[str, str], Ints]]:
    """Nodes, and elements of the regions by name and type: tetrahedra by gmsh between wedges where there are any."""
    if wedges is None:
        X, found = _tetrahedra(X, patches, regions, where)
        return X, {(name, "tet4"): conn for name, conn in found.items()}
    made = layered(X, patches, regions, *wedges, where)
    X, found = _tetrahedra(made.X, made.patches, made.regions, where)
    out: dict[tuple[str, str], Ints] = {}
    for name, conn in found.items():
        out[name, "tet4"] = conn
        if name in made.wedges:
            out[name, "penta6"] = made.wedges[name]
    return X, out


def _tetrahedra(X: Floats, patches: Sequence[Ints], regions: Sequence[Region],
                where: Where) -> tuple[Floats, dict[str, Ints]]:
    """Nodes, the given ones first, and tetrahedra of the regions, by gmsh: triangles of the patches are kept."""
    gmsh = import_extra("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for k in range(len(patches)):
            gmsh.model.addDiscreteEntity(2, k + 1)
        used, flat = np.unique(np.concatenate([p.ravel() for p in patches]), return_inverse=True)
        gmsh.model.mesh.addNodes(2, 1, np.arange(1, len(used) + 1), X[used].ravel())
        first = 1
        for k, conn in enumerate(np.split(flat.reshape(-1, 3), np.cumsum([len(p) for p in patches])[:-1]), 1):
            gmsh.model.mesh.addElementsByType(k, 2, np.arange(first, first + len(conn)), (conn + 1).ravel())
            first += len(conn)
        volumes = {}
        for r in regions:
            loop = gmsh.model.geo.addSurfaceLoop([k + 1 for k in r.patches])
            volumes[r.name] = gmsh.model.geo.addVolume([loop])
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(3)
        for method in ("", "Netgen"):  # slivers
            gmsh.model.mesh.optimize(method)
        tags, points, _ = gmsh.model.mesh.getNodes()
        new = tags > len(used)
        number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        number[1:len(used) + 1] = used
        number[tags[new]] = len(X) + np.arange(new.sum())
        found = {n: number[gmsh.model.mesh.getElementsByType(4, v)[1]].reshape(-1, 4) for n, v in volumes.items()}
        return np.concatenate([X, points.reshape(-1, 3)[new]]), found
    except Exception as e:  # gmsh raises nothing more particular
        raise InputError(f"gmsh cannot fill the surfaces: {e}", where) from None
    finally:
        gmsh.finalize()


def quadratic(made: Parts) -> Parts:
    """Parts of tet4 as tet10 with straight edges."""
    pairs = np.concatenate([np.sort(conn[:, list(e)], axis=1) for _, conn in made.parts.values() for e in TET_EDGES])
    edges, number = np.unique(pairs, axis=0, return_inverse=True)
    number = number.ravel() + len(made.X)
    X = np.concatenate([made.X, made.X[edges].mean(axis=1)])
    parts, at = {}, 0
    for name, (_, conn) in made.parts.items():
        n = len(conn)
        middles = number[at:at + n * len(TET_EDGES)].reshape(len(TET_EDGES), n).T
        parts[name] = ("tet10", np.concatenate([conn, middles], axis=1))
        at += n * len(TET_EDGES)
    return Parts(X, parts)


def import_extra(module: str) -> Any:
    """A module of the extra ``tets``, or an error that says how to get it."""
    from importlib import import_module

    try:
        return import_module(module)
    except (ImportError, OSError) as e:
        raise InputError(f'tetrahedra in images and surfaces need {module}: pip install "febkit[tets]" ({e})') from None

"""``febkit boundary``: hand a tissue's motion, pressure and concentrations to a cell model's surface."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from . import printing, units
from .outputs import FORCE, check
from .paths import INPUT, Output

if TYPE_CHECKING:
    import xarray as xr

    from febkit.coupling import Field, Handoff
    from febkit.model import Model


@dataclass(frozen=True, slots=True)
class Options:
    """What was asked for about the hand-off itself."""

    order: int | str | None
    fluid_order: int | None
    solute_order: int | None
    recovery: str | None
    overlay: bool
    rigid: str
    origin: str
    node_set: str | None
    form: str
    version: str
    section: bool
    must_points: bool
    pressure: bool
    units: str | None


def _order(_context: click.Context, _option: click.Parameter, value: str | None) -> int | str | None:
    return int(value) if value in ("1", "2", "3") else value


@click.command("boundary", context_settings={"max_content_width": 110})
@click.argument("source", type=INPUT)
@click.argument("cell", type=INPUT, required=False)
@click.option("--at", multiple=True, metavar="X,Y,Z", help="Point of the tissue; may be repeated.")
@click.option("--points", type=INPUT, help="CSV file of points: columns x, y, z and, if you like, name.")
@click.option("--order", type=click.Choice(["1", "2", "3", "auto"]), callback=_order, help="Order of the displacement "
              "[default: 2]; auto: at each point the orders with the least estimated error.")
@click.option("--fluid-order", type=click.IntRange(0, 3), help="Order of the pressure [default: that of the "
              "displacement, at most 2].")
@click.option("--solute-order", type=click.IntRange(0, 3), help="Order of the concentrations [default: that of "
              "the pressure].")
@click.option("--recovery", type=click.Choice(["patches", "polynomial", "element"]), help="How derivatives "
              "are found: superconvergent patch recovery [default]; a least-squares polynomial on the patch "
              "around the point; or the element's own (no pure second derivatives in a linear brick).")
@click.option("--overlay", is_flag=True, help="Interpolate the tissue's field at every node: no series.")
@click.option("--rigid", type=click.Choice(["drop", "keep", "drop-all"]), default="drop", show_default=True,
              help="The point's own displacement: dropped, kept, or dropped with its rotation.")
@click.option("--origin", default="0,0,0", show_default=True, metavar="X,Y,Z|centre",
              help="Place in the cell model that stands for the point.")
@click.option("--set", "node_set", help="Node set (or @surface:NAME) to drive [default: the outer surface].")
@click.option("--times", metavar="T,T,...", help="Times to sample the tissue at [default: its own].")
@click.option("--form", type=click.Choice(["auto", "math", "parameters", "curves"]), default="auto",
              show_default=True, help="Formulas; formulas that refer to curves; a curve per node and dof.")
@click.option("--version", "version", type=click.Choice(["4.0", "3.0", "2.5"]), default="4.0",
              show_default=True, help="Version of .feb to write.")
@click.option("--section", is_flag=True, help="Write the boundary sections alone, to be included.")
@click.option("--must-points/--no-must-points", default=True, show_default=True,
              help="Make the time stepper meet the tissue's times.")
@click.option("--pressure/--no-pressure", default=True, show_default=True,
              help="Prescribe the fluid pressure.")
@click.option("--dataset", type=Output(".nc"), help="Also save F, G, p, ... at the points as NetCDF.")
@units.OPTION
@click.option("-o", "--output", type=Output(".feb"), help="File to write; with several points their names are put "
              "before its ending [default: CELL_driven.feb].")
@FORCE
def command(source: Path, cell: Path | None, at: tuple[str, ...], points: Path | None, times: str | None,
            dataset: Path | None, output: Path | None, force: bool, **rest: Any) -> None:
    """Drive the surface of CELL (.feb) by SOURCE: a solved tissue (.xplt, .nc) or F(t), p(t), c(t) (.csv, .nc).

    \b
    febkit boundary tissue.xplt cell.feb --at 0,0,0 --order 2 -o driven.feb
    febkit boundary tissue.xplt cell.feb --points cells.csv --dataset series.nc
    febkit boundary experiment.csv cell.feb -o driven.feb
    """
    from febkit.feb import read
    from febkit.model import InputError

    options = Options(**rest)
    if cell is not None and output is None:
        output = cell.with_name(f"{cell.stem}_driven.feb")
    several = len(at) + (points is not None) > 1  # their names are put into the output's: checked when they are known
    check([dataset, None if several else output], [source, cell, points], force)
    if cell is None and dataset is None:
        raise InputError("nothing to write: give a cell model, or --dataset for F, G, p alone")
    model = None if cell is None else read(cell)
    tissue, driving = _driving(source, at, points, times, options, None if model is None else _offsets(model, options))
    if dataset is not None:
        if driving is None:
            raise InputError("--overlay makes no series: leave out --dataset")
        from febkit.results.netcdf import save

        save(driving, dataset, force)
        printing.say(f"wrote {dataset}")
    if model is not None:
        assert output is not None
        _drive_all(model, tissue, driving, at, points, options, output, [source, points], force)


def _drive_all(model: Model, tissue: Field | None, driving: xr.Dataset | None, at: tuple[str, ...],
               points: Path | None, options: Options, target: Path, inputs: list[Path | None], force: bool) -> None:
    from febkit.feb.read import sources

    places = None
    if driving is None:
        places, names = _places(at, points)
    else:
        names = [str(n) for n in driving["point"].values]
    stem, end = target.stem, target.suffix
    paths = [target] if len(names) == 1 else [target.with_name(f"{stem}_{_safe(n)}{end}") for n in names]
    check(paths, [*inputs, *sources(model)], force)
    for k, (name, path) in enumerate(zip(names, paths)):
        if len(names) > 1:
            printing.say(f"point {name}:")
        place = None if places is None else places[k]
        _drive_one(model, tissue, driving, k, place, options, path, force)


def _safe(name: str) -> str:
    return "".join(c if c.isalnum() or c in "-_." else "_" for c in name)


def _driving(source: Path, at: tuple[str, ...], points: Path | None, times: str | None,
             options: Options, box: Any) -> tuple[Field | None, xr.Dataset | None]:
    """The tissue, where SOURCE is one, and the series (None for an overlay); ``box`` is over which errors count."""
    from febkit.coupling import from_dataset, read_driving, series
    from febkit.coupling.errors import asked
    from febkit.model import InputError

    if _holds_series(source):
        given = {"--at": at, "--points": points, "--recovery": options.recovery, "--times": times,
                 "--overlay": options.overlay, "--units": options.units}
        wrong = [k for k, v in given.items() if v]
        if wrong:
            raise InputError(f"{source} holds F(t) already: {', '.join(wrong)} mean(s) nothing here")
        return None, read_driving(source)
    from febkit.results import open as open_results

    with open_results(source, units=options.units) as ds:
        field = from_dataset(ds)
    field = field if field.source else _named(field, source)
    if times is not None:
        field = field.at(_numbers(times, "--times"))
    places, names = _places(at, points)
    if options.overlay:
        return field, None
    if options.order == "auto" and box is None:
        raise InputError("--order auto: give the cell model, over whose box errors are estimated")
    others = max(options.fluid_order or 0, options.solute_order or 0)
    order = "auto" if options.order == "auto" else max(2 if options.order is None else int(options.order), others)
    ds = series(field, places, order=order, names=names, recovery=options.recovery, beyond=True, box=box)
    return field, ds if box is None else asked(ds, options.order, options.fluid_order, options.solute_order)


def _named(field: Field, source: Path) -> Field:
    from dataclasses import replace

    return replace(field, source=str(source))


def _holds_series(source: Path) -> bool:
    """True where the file is driving data and not a result."""
    if source.suffix.lower() in (".csv", ".txt", ".tsv"):
        return True
    if source.suffix.lower() not in (".nc", ".nc4", ".h5", ".cdf"):
        return False
    from febkit.results import netcdf

    with netcdf.opened(source) as ds:
        return "F" in ds


def _places(at: tuple[str, ...], points: Path | None) -> tuple[Any, list[str]]:
    import numpy as np

    from febkit.coupling import read_points
    from febkit.model import InputError

    rows, names = [], []
    for k, text in enumerate(at):
        rows.append(_numbers(text, "--at", 3))
        names.append(str(k))
    if points is not None:
        more, labels = read_points(points)
        rows += list(more)
        names += labels
    if not rows:
        raise InputError("which point of the tissue? --at X,Y,Z or --points FILE")
    if len(set(names)) < len(names):
        names = [str(k) for k in range(len(names))]
    return np.array(rows), names


def _numbers(text: str, option: str, count: int | None = None) -> Any:
    import numpy as np

    from febkit.model import InputError

    try:
        v = np.array([float(x) for x in text.replace(",", " ").split()])
    except ValueError:
        raise InputError(f"{option} {text}: numbers with commas between are wanted") from None
    if not np.isfinite(v).all() or not len(v) or (count is not None and len(v) != count):
        raise InputError(f"{option} {text}: {count or 'some'} finite numbers are wanted")
    return v


def _drive_one(model: Model, tissue: Field | None, driving: xr.Dataset | None, point: int, place: Any,
               options: Options, path: Path, force: bool) -> None:
    """Writes one driven model or section, and says what was found."""
    from febkit.coupling import check, drive, with_solutes, write, write_section

    nodes = _nodes(model, options.node_set)
    X = model.mesh.X[nodes]
    _same_units(tissue, driving, model)
    given = _handoff(X, tissue, driving, point, place, options)
    if not options.pressure:
        given = given.without_pressure()
    given = with_solutes(given, model)
    found = check(given, driving, point)
    for line in found.lines:
        printing.say(f"  {line}")
    for problem in found.problems:
        printing.warn(problem)
    driven = drive(model, given, nodes, node_set=options.node_set, form=options.form, version=options.version,
                   must_points=options.must_points)
    for line in driven.said:
        printing.say(f"  {line}")
    if options.section:
        write_section(driven, path, options.version, force)
    else:
        for lost in write(driven, path, options.version, force) or ():
            printing.warn(lost)
    printing.say(f"wrote {path} ({options.version}, {driven.form})")


def _same_units(tissue: Field | None, driving: xr.Dataset | None, model: Model) -> None:
    from febkit.coupling import same_units

    name = driving.attrs.get("unit_system") if driving is not None else tissue.units if tissue else None
    same_units(name, model.units)
    if model.units and not name:
        printing.say(f"  units: the tissue names none and is taken to be in those of the cell model, {model.units}")


def _handoff(X: Any, tissue: Field | None, driving: xr.Dataset | None, point: int, place: Any,
             options: Options) -> Handoff:
    from febkit.coupling import handoff, overlay
    from febkit.coupling.taylor import orders

    origin = _origin(X, options)
    if driving is None:
        assert tissue is not None
        return overlay(tissue, X, place, rigid=options.rigid, origin=origin)
    order = options.order
    if order is None:
        order = "auto" if "solid_order" in driving else min(2, orders(driving)[0])
    return handoff(driving, X, point=point, order=order, fluid_order=options.fluid_order,
                   solute_order=options.solute_order, rigid=options.rigid, origin=origin)


def _origin(X: Any, options: Options) -> Any:
    """The place in the cell model that stands for the point of the tissue."""
    from febkit.model import InputError

    low, high = X.min(axis=0), X.max(axis=0)
    if options.origin.strip().lower() in ("centre", "center"):
        return 0.5 * (low + high)
    origin = _numbers(options.origin, "--origin", 3)
    span = (high - low).max()
    if ((origin < low - 0.5 * span) | (origin > high + 0.5 * span)).any():
        raise InputError(f"the origin {options.origin} lies far outside the cell model, which spans "
                         f"{low} to {high}: say --origin centre, or where the point lies in it")
    return origin


def _offsets(model: Model, options: Options) -> Any:
    """Driven nodes (n, 3) from the point."""
    X = model.mesh.X[_nodes(model, options.node_set)]
    return X - _origin(X, options)


def _nodes(model: Model, node_set: str | None) -> Any:
    import numpy as np

    from febkit.coupling import surface_nodes
    from febkit.model.sets import node_indices

    if node_set is None:
        return surface_nodes(model.mesh)
    return np.asarray(node_indices(model.mesh, node_set))

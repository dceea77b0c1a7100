"""``febkit convert``: between .feb versions, results formats and mesh formats."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import click

from . import exits, printing
from .outputs import FORCE, check
from .paths import INPUT, Output

RESULTS = (".xplt", ".plt", ".nc")
VERSIONS = ("4.0", "3.0", "2.5", "2.0", "1.2")


@click.command("convert", context_settings={"max_content_width": 110})
@click.argument("source", type=INPUT)
@click.argument("target", type=Output())
@click.option("--to", "version", type=click.Choice(VERSIONS), help="Version of a .feb target [default: 4.0].")
@click.option("-v", "--variable", "variables", multiple=True, help="Convert this result only; may repeat.")
@click.option("--deformed", is_flag=True, help="Results at their deformed places.")
@click.option("--compress/--no-compress", default=None, help="Compress an .xplt or .nc target.")
@click.option("--strict", is_flag=True, help="Write nothing, exit code 1, where the version cannot say all.")
@FORCE
def command(source: Path, target: Path, version: str | None, variables: tuple[str, ...], deformed: bool,
            compress: bool | None, strict: bool, force: bool) -> None:
    """Convert SOURCE to TARGET by their endings.

    \b
    febkit convert old.feb new.feb              any .feb version to 4.0
    febkit convert new.feb old.feb --to 2.5     what 2.5 cannot say is listed
    febkit convert run.xplt run.pvd             all states for ParaView
    febkit convert run.xplt run.nc              xarray's NetCDF
    febkit convert mesh.msh model.feb           any mesh of meshio, with a material stub
    febkit convert model.feb mesh.vtu           the mesh of a model
    """
    a, b = source.suffix.lower(), target.suffix.lower()
    given = {"--to": version, "-v": variables, "--deformed": deformed, "--strict": strict,
             "--compress": compress is not None}
    if a == b == ".feb":
        _means(given, "--to", "--strict")
        _model(source, target, version or "4.0", strict, force)
    elif a in RESULTS:
        _means(given, "-v", "--deformed", "--compress")
        _results(source, target, variables, deformed, compress, force)
    elif b in (*RESULTS, ".pvd"):
        raise exits.Refused(f"{target}: {b} holds results, and {source} has none: febkit run makes them")
    else:
        _means(given, *(["--to"] if b == ".feb" else []))
        _mesh(source, target, version or "4.0", force)


def _means(given: Mapping[str, object], *known: str) -> None:
    """Refuse options that would change nothing."""
    other = [name for name, value in given.items() if value and name not in known]
    if other:
        raise click.UsageError(f"{', '.join(other)} mean{'s' * (len(other) == 1)} nothing for these kinds of file")


def _model(source: Path, target: Path, version: str, strict: bool, force: bool) -> None:
    from febkit.feb import read, to_bytes
    from febkit.feb.read import sources
    from febkit.files import put

    check([target], [source], force)
    model = read(source)
    check([target], sources(model), force)
    data, notes = to_bytes(model, version)
    for note in notes:
        printing.warn(f"not said in version {version}: {note}")
    if strict and notes:
        printing.fail(f"{target} is not written")
        raise click.exceptions.Exit(exits.NO)
    put(target, data, force)
    printing.say(f"wrote {target} (febio_spec {version}, {len(notes)} note{'s' * (len(notes) != 1)})")


def _results(source: Path, target: Path, variables: tuple[str, ...], deformed: bool,
             compress: bool | None, force: bool) -> None:
    from febkit.results.export import export

    written = export(source, target, variables=variables or None, deformed=deformed, compress=compress,
                     overwrite=force)
    more = f" and {len(written) - 1} more" if len(written) > 1 else ""
    printing.say(f"wrote {written[0]}{more}")


def _mesh(source: Path, target: Path, version: str, force: bool) -> None:
    from febkit.meshio_format import read_mesh, write_mesh

    check([target], [source], force)
    mesh = read_mesh(source)
    if target.suffix.lower() == ".feb":
        from febkit.feb import write
        from febkit.meshio_format import to_model

        for note in write(to_model(mesh, str(source)), target, version, force):
            printing.warn(f"not said in version {version}: {note}")
    else:
        for line in write_mesh(mesh, target, force):
            printing.note(f"meshio: {line}")
    printing.say(f"wrote {target}")

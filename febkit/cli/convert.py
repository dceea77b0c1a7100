"""``febkit convert``: between .feb versions, results formats and mesh formats."""

from __future__ import annotations

from pathlib import Path

import click

from .outputs import FORCE, check

RESULTS = (".xplt", ".plt", ".nc")
VERSIONS = ("4.0", "3.0", "2.5", "2.0", "1.2")


@click.command("convert", context_settings={"max_content_width": 110})
@click.argument("source", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("target", type=click.Path(dir_okay=False, path_type=Path))
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
    if a == b == ".feb":
        _model(source, target, version or "4.0", strict, force)
    elif a in RESULTS:
        _results(source, target, variables, deformed, compress, force)
    else:
        _mesh(source, target, version or "4.0", force)


def _model(source: Path, target: Path, version: str, strict: bool, force: bool) -> None:
    from febkit.feb import read, to_bytes
    from febkit.feb.read import sources
    from febkit.files import put

    check([target], [source], force)
    model = read(source)
    check([target], sources(model), force)
    data, notes = to_bytes(model, version)
    for note in notes:
        click.echo(f"not said in version {version}: {note}", err=True)
    if strict and notes:
        click.echo(f"{target} is not written", err=True)
        raise click.exceptions.Exit(1)
    put(target, data, force)
    click.echo(f"{target}: febio_spec {version}, {len(notes)} notes")


def _results(source: Path, target: Path, variables: tuple[str, ...], deformed: bool,
             compress: bool | None, force: bool) -> None:
    from febkit.results.export import export

    written = export(source, target, variables=variables or None, deformed=deformed, compress=compress,
                     overwrite=force)
    more = f" and {len(written) - 1} more" if len(written) > 1 else ""
    click.echo(f"{written[0]}{more}")


def _mesh(source: Path, target: Path, version: str, force: bool) -> None:
    from febkit.meshio_format import read_mesh

    check([target], [source], force)
    mesh = read_mesh(source)
    if target.suffix.lower() == ".feb":
        from febkit.feb import write
        from febkit.meshio_format import to_model

        for note in write(to_model(mesh, str(target)), target, version, force):
            click.echo(f"not said in version {version}: {note}", err=True)
    else:
        from meshio import WriteError

        from febkit.files import written

        try:
            with written(target, force) as part:
                mesh.write(part)
        except (WriteError, KeyError, ValueError) as e:
            raise click.UsageError(f"meshio cannot write {target.name}: {e}") from None
    click.echo(str(target))

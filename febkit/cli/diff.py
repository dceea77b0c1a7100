"""``febkit diff``: two inputs by meaning, or two results by norms."""

from __future__ import annotations

from pathlib import Path

import click

from . import exits, printing
from .numbers import NOT_NEGATIVE
from .paths import INPUT


@click.command("diff", context_settings={"max_content_width": 110})
@click.argument("a", type=INPUT)
@click.argument("b", type=INPUT)
@click.option("--rtol", default=None, type=NOT_NEGATIVE, help="Relative tolerance [default: 1e-5; inputs 1e-9].")
@click.option("--atol", default=0.0, type=NOT_NEGATIVE, show_default=True, help="Absolute tolerance, per value.")
@click.option("-v", "--variable", "variables", multiple=True, help="Compare this variable only; may repeat.")
@click.option("--all", "every", is_flag=True, help="A line per variable and state, not only the worst.")
@click.option("-q", "--quiet", is_flag=True, help="Say nothing; the exit code tells.")
def command(
    a: Path, b: Path, rtol: float | None, atol: float, variables: tuple[str, ...], every: bool, quiet: bool
) -> None:
    """Compare two inputs (.feb) by meaning, or two plotfiles (.xplt) by norms per variable and time.

    Exit code 0 where they agree, 1 where they differ, 2 where they cannot be compared. Nodes and elements
    are matched by id. A state agrees where |a-b| is within rtol of the variable's largest norm over time.

    \b
    febkit diff old.feb new.feb
    febkit diff febio.xplt febkit.xplt --rtol 1e-4 -v displacement -v stress
    """
    kinds = {p.suffix.lower() for p in (a, b)}
    if kinds == {".feb"}:
        same = _inputs(a, b, 1e-9 if rtol is None else rtol, quiet)
    elif kinds == {".xplt"}:
        same = _results(a, b, 1e-5 if rtol is None else rtol, atol, variables, every, quiet)
    else:
        raise click.UsageError("give two .feb or two .xplt files")
    raise click.exceptions.Exit(exits.DONE if same else exits.NO)


def _inputs(a: Path, b: Path, rtol: float, quiet: bool) -> bool:
    from febkit.feb import diff, read

    found = diff(read(a), read(b), rtol)
    if not quiet:
        for d in found:
            printing.say(f"{d.what}: {d.a or '-'} | {d.b or '-'}")
        printing.say(f"{len(found)} differences" if found else "same meaning")
    return not found


def _results(
    a: Path, b: Path, rtol: float, atol: float, variables: tuple[str, ...], every: bool, quiet: bool
) -> bool:
    from febkit.results.difference import difference, lines

    d = difference(a, b, variables=variables)
    same = d.agrees(rtol, atol)
    if not quiet:
        for line in lines(d, rtol, atol, every):
            printing.say(line)
        printing.say(f"{'agree' if same else 'differ'} (rtol {rtol:g}, atol {atol:g})")
    return same

"""``febkit validate``: check an input without solving it."""

from __future__ import annotations

from pathlib import Path

import click

SEVERITIES = ("error", "unsupported", "warning", "hint")


@click.command("validate", context_settings={"max_content_width": 110})
@click.argument("files", nargs=-1, required=True,
                type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--solver/--no-solver", default=True, show_default=True,
              help="Also ask whether febkit can solve it.")
@click.option("--strict", is_flag=True, help="Warnings count as errors.")
@click.option("-q", "--quiet", is_flag=True, help="Errors only.")
def command(files: tuple[Path, ...], solver: bool, strict: bool, quiet: bool) -> None:
    """Check .feb inputs offline: tags, references, curves, elements; say what febkit cannot solve.

    Exit code 0 where nothing is wrong, 2 where there are errors or features that febkit does not solve.

    \b
    febkit validate model.feb
    febkit validate *.feb --no-solver
    """
    from febkit.feb import validate

    bad = False
    for file in files:
        found = validate(file, solvable=solver)
        counts = {s: sum(f.severity == s for f in found) for s in SEVERITIES}
        bad |= counts["error"] + counts["unsupported"] + (counts["warning"] if strict else 0) > 0
        for f in found:
            if not quiet or f.severity == "error":
                click.echo(str(f))
        if not quiet:
            click.echo(f"{file}: {_verdict(counts, solver)}")
    if bad:
        raise click.exceptions.Exit(2)


def _verdict(counts: dict[str, int], solver: bool) -> str:
    said = [f"{n} {s}{'s' if n != 1 and s != 'unsupported' else ''}" for s, n in counts.items() if n]
    text = ", ".join(said) if said else "nothing to say"
    if counts["error"]:
        return f"{text}; not solvable as it is"
    if not solver:
        return text
    return f"{text}; febkit {'cannot solve it' if counts['unsupported'] else 'can solve it'}"

"""``febkit validate``: check an input without solving it."""

from __future__ import annotations

from pathlib import Path

import click

from . import exits, printing
from .paths import INPUT

SEVERITIES = ("error", "unsupported", "warning", "hint")


@click.command("validate", context_settings={"max_content_width": 110})
@click.argument("files", nargs=-1, required=True,
                type=INPUT)
@click.option("--solver/--no-solver", default=True, show_default=True,
              help="Also ask whether febkit can solve it.")
@click.option("--strict", is_flag=True, help="Warnings count as errors.")
@click.option("-q", "--quiet", is_flag=True, help="Print only what makes the exit code 2.")
def command(files: tuple[Path, ...], solver: bool, strict: bool, quiet: bool) -> None:
    """Check .feb inputs offline: tags, references, curves, elements; say what febkit cannot solve.

    Exit code 0 where nothing is wrong, 2 where there are errors or features that febkit does not solve.

    \b
    febkit validate model.feb
    febkit validate *.feb --no-solver
    """
    from febkit.feb import validate

    bad, fatal = False, ("error", "unsupported", *(["warning"] if strict else []))
    for file in files:
        found = validate(file, solvable=solver)
        counts = {s: sum(f.severity == s for f in found) for s in SEVERITIES}
        bad |= any(counts[s] for s in fatal)
        for f in found:
            if not quiet or f.severity in fatal:
                printing.say(f)
        if not quiet:
            printing.say(f"{file}: {_verdict(counts, solver)}")
    if bad:
        raise click.exceptions.Exit(exits.BAD_INPUT)


def _verdict(counts: dict[str, int], solver: bool) -> str:
    said = [f"{n} {s}{'s' if n != 1 and s != 'unsupported' else ''}" for s, n in counts.items() if n]
    text = ", ".join(said) if said else "nothing to say"
    if counts["error"]:
        return f"{text}; not solvable as it is"
    if not solver:
        return text
    return f"{text}; febkit {'cannot solve it' if counts['unsupported'] else 'can solve it'}"

"""``febkit features``: what FEBio registers, and what febkit does with each."""

from __future__ import annotations

import click

from . import printing

OTHERS = "reads, converts and writes"


@click.command("features", context_settings={"max_content_width": 110})
@click.argument("kinds", nargs=-1)
@click.option("--missing", is_flag=True, help="Only the types that febkit does not solve.")
@printing.STYLE
def command(kinds: tuple[str, ...], missing: bool, style: str) -> None:
    """List FEBio's types of these kinds (loads, materials, ...; all kinds in numbers where none is named).

    Everything is read, converted and written; what is not solved is refused by name.

    \b
    febkit features
    febkit features contact "plot variable"
    febkit features material --missing --style csv
    """
    from febkit.census import census, everything
    from febkit.metrics.tables import Table
    from febkit.model.reasons import reason

    chosen = tuple(_kind(k, tuple(everything())) for k in kinds)
    entries = [e for e in census(chosen) if not (missing and e.solved)]
    if kinds or missing:
        rows = [(e.kind, e.name, *(("solves", "") if e.solved else (OTHERS, reason(e.name)))) for e in entries]
        printing.table(Table("", ("kind", "type", "febkit", "why not"), rows), style)
        return
    solved = [e.kind for e in entries if e.solved]
    counts = [(k, len(names), solved.count(k)) for k, names in everything().items()]
    counts.append(("all", len(entries), len(solved)))
    printing.table(Table("", ("kind", "FEBio registers", "febkit solves"), counts), style)


def _kind(said: str, kinds: tuple[str, ...]) -> str:
    """A kind by its name, singular or plural. Raises click.UsageError with those there are."""
    for k in kinds:
        if said.lower() in (k, f"{k}s", f"{k[:-1]}ies"):
            return k
    raise click.UsageError(f'no kind is called "{said}"; there are {", ".join(kinds)}')

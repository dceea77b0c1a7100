"""``febkit view``: results in the browser."""

from __future__ import annotations

from pathlib import Path

import click

from . import printing, units
from .paths import INPUT


@click.command("view", context_settings={"max_content_width": 110})
@click.argument("results", type=INPUT)
@click.option("-v", "--variable", help='Drawn first: "effective fluid pressure", "stress:zz", "stress:first".')
@click.option("-m", "--model", type=INPUT, help="Model of the run [default: .feb beside RESULTS].")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Port of the page [default: any that is free].")
@click.option("--no-browser", is_flag=True, help="Print the address only.")
@units.OPTION
def command(
    results: Path, variable: str | None, model: Path | None, port: int, no_browser: bool, units: str | None
) -> None:
    """Look at RESULTS in the browser (needs febkit[viewer]); Ctrl-C ends it.

    Time, variables and components, deformation, parts, cuts; a click says the element, the node and the value.
    A run that is still going is followed.
    """
    from febkit.viewer import view

    from .metrics import opened

    ds, found = opened(results, model, units)
    system = ds.attrs.get("unit_system")
    ds.close()
    shown = view(results, variable, model=found, units=units or (found and system) or None, port=port)
    printing.say(f"{results.name} is shown at {shown.url} (Ctrl-C ends)")
    if not no_browser:
        import webbrowser

        webbrowser.open(shown.url)
    try:
        shown.wait()
    except KeyboardInterrupt:
        shown.stop()

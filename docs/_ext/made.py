"""Pages that are made from the package itself when the site is built: constructors of materials, the command line."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parents[1] / "_made"


def setup(app: Any) -> dict[str, bool]:
    app.connect("builder-inited", lambda app: write())
    return {"parallel_read_safe": True}


def write() -> None:
    """Write the pages anew where they changed, so that builds after the first are quick."""
    FOLDER.mkdir(exist_ok=True)
    for name, text in (("materials", materials()), ("verbs", verbs())):
        path = FOLDER / f"{name}.md"
        if not path.is_file() or path.read_text() != text:
            path.write_text(text)


def materials() -> str:
    """A section for each constructor that the solver has a law for: its parameters, defaults, ranges."""
    from febkit import materials as mt
    from febkit.model import Component, ranges
    from febkit.modelling import schema

    out = ["# Materials", "", INTRODUCTION]
    named = sorted(mt.names().items(), key=lambda item: item[0].lower())
    for name, kind in named:
        law = schema.record(Component("material", kind))
        if law is None and kind not in mt.MIXTURES:
            continue
        out += [f"## {name}", "", f'FEBio\'s "{kind}".', ""]
        limits = ranges.of(kind)
        rows = []
        for p in inspect.signature(mt.constructor(name)).parameters.values():
            tag = schema.tag(p.name, schema.parameters(Component("material", kind))) or p.name
            default = "required" if p.default is p.empty else "" if p.default is None else f"{p.default}"
            rows.append(f"| `{p.name}` | {default} | {limits[tag].said if tag in limits else ''} |")
        if rows:
            out += ["| parameter | default | must be |", "|---|---|---|", *rows, ""]
        text = inspect.getdoc(law) if law is not None else None
        if text:
            out += ["```text", text, "```", ""]
    return "\n".join(out) + "\n"


def verbs() -> str:
    """What `febkit VERB --help` says, verb by verb."""
    import click

    from febkit.cli.main import VERBS, cli

    out = ["# The command line, verb by verb", "", "What `febkit VERB --help` prints.", ""]
    for verb in VERBS:
        command = cli.get_command(click.Context(cli), verb)
        assert command is not None
        with click.Context(command, info_name=f"febkit {verb}", max_content_width=100, terminal_width=100) as context:
            out += [f"## febkit {verb}", "", "```text", command.get_help(context), "```", ""]
    return "\n".join(out) + "\n"


INTRODUCTION = """\
Constructors of `febkit.materials`, one for each of FEBio's types that the solver has, made from the solver's own
records: the text below a table is the record's. `febkit.materials.of("neo-Hookean", E=0.6, v=0.1)` makes any of
FEBio's materials by its type, those too that febkit writes but does not solve. A parameter is a number, a formula of
X, Y, Z and t, a map, or, for a property, another material; numbers are held against FEBio's ranges when they are set.
"""

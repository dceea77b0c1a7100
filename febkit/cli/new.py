"""``febkit new``: write a model of the study, or of one's own template folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from . import printing
from .outputs import FORCE, check
from .paths import INPUT, Output

if TYPE_CHECKING:
    from febkit.model import Where
    from febkit.templates.template import Template


@click.command("new", context_settings={"max_content_width": 110})
@click.argument("name", metavar="tissue|cell|embedded|cartilage|chondron")
@click.option("--case", type=click.Choice(["A", "B", "C", "D"]), help="Loading of the study: "
              "top moves evenly (A, B) or unevenly (C, D); draining at top and bottom (A, C) or top (B, D).")
@click.option("--physics", type=click.Choice(["biphasic", "triphasic", "multiphasic"]), help="Solid and water, or with "
              "fixed charges and ions as well (triphasic; of cartilage multiphasic).")
@click.option("--set", "pairs", multiple=True, metavar="NAME=VALUE",
              help="Value of a parameter; may be repeated. size=small is a reduced mesh.")
@click.option("--params", type=INPUT, help="TOML file of parameters.")
@click.option("--template", type=click.Path(file_okay=False, path_type=Path),
              help="Folder with a template.toml and a model.feb of your own.")
@click.option("-o", "--output", type=Output(".feb"),
              help="The .feb file to write [default: NAME_CASE.feb].")
@FORCE
@click.option("--parameters", is_flag=True, help="List the parameters with units and defaults, and stop.")
def command(name: str, case: str | None, physics: str | None, pairs: tuple[str, ...], params: Path | None,
            template: Path | None, output: Path | None, force: bool, parameters: bool) -> None:
    """Write a complete model: the study's tissue cube, its cell cube, the cells embedded in the tissue, whole
    cartilage, or one chondron.

    \b
    febkit new tissue --case B -o tissue.feb
    febkit new cell --case B --set seed=7 --set diameter=0.012 -o cell.feb
    febkit new embedded --case D --set size=small -o control.feb
    febkit new tissue --case B --physics triphasic
    febkit new cartilage --set shape=disc --set E=profile.csv
    febkit new chondron --set shift=0.0002 --params materials.toml
    febkit new cell --parameters
    """
    from febkit.templates.profile import Profile
    from febkit.templates.template import load

    template_ = load(name, template)
    if parameters:
        printing.say(_listing(template_))
        return
    values = template_.values(_given(template_, {"case": case, "physics": physics}, pairs, params))
    target = output or Path(f"{name}_{values['case']}.feb" if "case" in values else f"{name}.feb")
    own = (template / "template.toml", template / "model.feb") if template else ()
    tables = [v.file for v in values.values() if isinstance(v, Profile) and v.file]
    check([target], [params, *own, *tables, str(values.get("mesh_file") or "") or None], force)
    model, made = template_.build(values)
    from febkit.feb import write

    write(model, target, overwrite=force)
    for line in _summary(made.report):
        printing.say(line)
    printing.say(f"wrote {target}")


def _given(template: Template, choices: dict[str, str | None], pairs: tuple[str, ...],
           params: Path | None) -> list[tuple[dict[str, Any], Where]]:
    """The user's values: the file first, then those that have an option of their own, then --set."""
    from febkit.model import InputError, Where
    from febkit.templates.parameters import from_text
    from febkit.templates.template import parameters_file

    given: list[tuple[dict[str, Any], Where]] = []
    if params is not None:
        table, where = parameters_file(params)
        for owner, key in [(table, "mesh_file"), *((t, "file") for t in table.values() if isinstance(t, dict))]:
            if isinstance(owner.get(key), str) and owner[key] and not Path(owner[key]).is_absolute():
                owner[key] = str(params.parent / owner[key])
        given.append((table, where))
    here = Where("--set")
    given += [({k: v}, Where(f"--{k}")) for k, v in choices.items() if v is not None]
    for pair in pairs:
        name, equals, text = pair.partition("=")
        name = name.strip()
        if not equals or not name:
            raise InputError(f"--set {pair}: write name=value", here)
        known = template.parameters.get(name)
        value = text.strip() if known is not None and known.kind == "text" else from_text(text.strip())
        given.append(({name: value}, here))
    return given


def _listing(template: Template) -> str:
    """All parameters, one paragraph each."""
    from textwrap import fill

    lines = [template.title, ""]
    for p in template.parameters.values():
        unit = f" {p.unit}" if p.unit else ""
        bounds = [f"{k} {v:g}" for k, v in p.limits.items()]
        bounds += [f"one of {', '.join(map(str, p.choices))}"] if p.choices else []
        shown = '""' if p.default == "" else p.default
        extra = f"  ({'; '.join(bounds)})" if bounds else ""
        lines.append(fill(f"{p.name} = {shown}{unit}{extra}", 100, subsequent_indent="  "))
        lines.append(fill(p.doc, 100, initial_indent="    ", subsequent_indent="    "))
    for size, values in template.sizes.items():
        lines.append(f"size = {size}: " + ", ".join(f"{k} = {v}" for k, v in values.items()))
    return "\n".join(lines)


def _summary(report: Any) -> list[str]:
    """Counts, quality and volume fractions, a line each."""
    lines = []
    for key, value in report.items():
        if key == "centres":
            continue
        lines.append(f"{key}: {value:.5f}" if isinstance(value, float) else f"{key}: {value}")
    return lines

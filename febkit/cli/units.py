"""``--units``: tells the unit system of results that name none, and what is said where nobody does."""

from __future__ import annotations

import click

from febkit.units import SYSTEMS

OPTION = click.option(
    "--units", type=click.Choice(list(SYSTEMS)), metavar="SYSTEM",
    help=f"Unit system of results that name none: {', '.join(SYSTEMS)}.",
)  # fmt: skip
UNKNOWN = ("units: neither the result nor its model names any, so numbers are plain, in the units of the model, and "
           "mass exchange is a rate of volume; --units SYSTEM tells")

"""Why types of FEBio 4.11 are not solved: a reason, and the types it is of."""

from __future__ import annotations

from functools import cache

REASONS = r"""
FEBio 4.11 itself does not take it for a material: elastic membrane; wrinkle Ogden
FEBio 4.11 never gives it what it acts on: discrete contact; discrete contact2; point
it is of materials of second order, which have gradients of strains: 2O microfluc; micro-material2O; mindlin
  elastic; periodic boundary2O
FEBio makes it itself, between the sides of representative volumes: periodic boundary1O
its fibers lie on spheres that FEBio meshes anew by their density: fiberODF
it meshes the model anew by a library that febkit does not have: mmg_remesh
it reads an image: image map
it acts within a radius that FEBio 4.11 never sets, but for its plugins: sbm point source; solute point source
febkit has no contact over cut facets; sliding-elastic and tied-elastic serve the same ends: mortar-sliding; mortar-tied
febkit ties opposite faces by linear constraints: periodic boundary; surface constraint
febkit has no contact of edges: edge-to-surface contact potential; edge-to-surface sliding contact
febkit's conjugate gradients go along plain residuals: preconditioner
it makes where a step ended the reference, which febkit keeps throughout: prestrain
the older form of sliding-biphasic, which serves the same end: sliding2
febkit takes the usual integration of the element: sri-solid; udg-hex
no model of FEBio's public suite has it, and febkit does not yet: multiphasic-multigeneration; pipette aspiration;
  pressure_stabilization; surface attraction; sliding-biphasic-mixed; defgrad;
  parabolic map
springs do not erode in febkit: spring force; spring stretch
"""


@cache
def _reasons() -> dict[str, str]:
    lines = (line.split(": ", 1) for line in REASONS.strip().replace("\n  ", " ").split("\n"))
    return {name: reason for reason, names in lines for name in names.split("; ")}


def reason(type_: str) -> str:
    """Why a type is not solved, "" where there is nothing to say but that it is not."""
    return _reasons().get(type_, "")

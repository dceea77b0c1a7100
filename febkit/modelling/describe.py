"""A model in words: what ``febkit info`` prints and a notebook shows."""

from __future__ import annotations

from collections.abc import Iterator

from febkit.model import Model, Step


def model_lines(model: Model) -> Iterator[str]:
    """A model in words."""
    m = model.mesh
    units = f", units {model.units}" if model.units else ""
    yield f"febio_spec {model.version}, module {model.module}{units}"
    yield f"nodes     {len(m.node_ids)}"
    yield f"elements  {sum(len(b.ids) for b in m.blocks)}"
    material = {d.block: d.material for d in model.domains}
    for b in m.blocks:
        yield f"  part {b.name}: {len(b.ids)} {b.type}, material {material.get(b.name) or '-'}"
    for c in model.materials:
        inner = [f"{k.tag} {k.type}" for k in c if k.type]
        yield f"  material {c.name or c.id}: {c.type}" + (f" ({', '.join(inner)})" if inner else "")
    sets = (
        ("node sets", {k: len(v.nodes) for k, v in m.node_sets.items()}),
        ("surfaces", {k: sum(map(len, v.facets.values())) for k, v in m.surfaces.items()}),
        ("element sets", {k: len(v.elements) for k, v in m.element_sets.items()}),
        ("discrete sets", {k: len(v.pairs) for k, v in m.discrete_sets.items()}),
    )
    for title, sizes in sets:
        yield from sizes_line(title, sizes)
    yield from _step("all steps", model.common)
    for i, step in enumerate(model.steps, start=1):
        yield from _step(f"step {i}", step)
    if model.controllers:
        yield f"load controllers  {len(model.controllers)}"
    if model.output.plot:
        yield f"plots     {', '.join(v.type for v in model.output.plot)}"


def _step(name: str, step: Step) -> Iterator[str]:
    said = []
    if step.control is not None:
        c = step.control
        said.append(f"{c.str('analysis', '?').lower()}, {c.str('time_steps')} steps of {c.str('step_size')}")
    for key in ("boundary", "loads", "contact", "constraints", "rigid", "initial"):
        held = getattr(step, key)
        if held:
            said.append(f"{len(held)} {key} ({', '.join(dict.fromkeys(c.type or c.tag for c in held))})")
    if said:
        yield f"{name}: {'; '.join(said)}"


def sizes_line(title: str, sizes: dict[str, int]) -> Iterator[str]:
    if sizes:
        yield f"{title:<9} {', '.join(f'{k} ({n})' for k, n in sizes.items())}"

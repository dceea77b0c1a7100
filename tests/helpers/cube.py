"""One-element .feb files for tests of the lowering."""

from __future__ import annotations

from pathlib import Path

import febkit
from febkit.lower import lower
from febkit.solver.problem import Problem

_NODES = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def text(material: str, *, constants: str = "", control: str = "", more: str = "", module: str = "solid") -> str:
    """A unit cube of ``material`` (the <material> element), its base held; ``more`` follows <Boundary>."""
    nodes = "".join(f'<node id="{k + 1}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(_NODES))
    control = control or "<time_steps>1</time_steps><step_size>1</step_size>"
    return f"""<?xml version="1.0"?>
<febio_spec version="4.0">
<Module type="{module}"/>
<Control><analysis>STATIC</analysis>{control}</Control>
<Globals><Constants>{constants}</Constants></Globals>
<Material>{material}</Material>
<Mesh>
<Nodes name="all">{nodes}</Nodes>
<Elements type="hex8" name="cube"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<NodeSet name="base">1,2,3,4</NodeSet>
<NodeSet name="top">5,6,7,8</NodeSet>
</Mesh>
<MeshDomains><SolidDomain name="cube" mat="m"/></MeshDomains>
<Boundary>
<bc node_set="base" type="zero displacement"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
</Boundary>
{more}
</febio_spec>
"""


def read(folder: Path, content: str) -> febkit.Model:
    path = folder / "cube.feb"
    path.write_text(content)
    return febkit.read(path)


def problem(folder: Path, content: str) -> Problem:
    return lower(read(folder, content))

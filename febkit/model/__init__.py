"""Frozen records of a model. The model knows no file format and no solver."""

from . import values
from .component import Component
from .mesh import DiscreteSet, Edge, ElementBlock, ElementSet, Mesh, NodeSet, Surface, SurfacePair
from .model import Domain, LoadController, LogEntry, MeshData, Model, Output, PlotVariable, Step, as_record
from .source import InputError, UnsupportedError, Where

__all__ = [
    "Component", "DiscreteSet", "Domain", "Edge", "ElementBlock", "ElementSet", "InputError",
    "LoadController", "LogEntry", "Mesh", "MeshData", "Model", "NodeSet", "Output", "PlotVariable",
    "Step", "Surface", "SurfacePair", "UnsupportedError", "Where", "as_record", "values",
]

"""Fits of models to experiments: :func:`febkit.fit`, and FEBio's optimisation files."""

from __future__ import annotations

from .experiment import Experiment
from .parameters import Parameter
from .result import Fit
from .run import fit

__all__ = ["Experiment", "Fit", "Parameter", "fit"]

"""What the study printed: its table 2, as data."""

from __future__ import annotations

from collections.abc import Mapping

from febkit.metrics.cells import METRICS

SOURCE = "Sibole et al. 2013, table 2"
# case, order of solid and fluid -> RMS difference over the control's range (eq 20), in the order of METRICS
_NRMS = {
    ("A", 1): (0.048, 0.038, 0.064, 0.059, 0.070, 0.091),
    ("A", 2): (0.048, 0.038, 0.064, 0.059, 0.070, 0.091),
    ("B", 1): (0.083, 0.070, 0.318, 0.303, 0.319, 0.129),
    ("B", 2): (0.074, 0.056, 0.128, 0.115, 0.127, 0.128),
    ("C", 1): (0.052, 0.040, 0.079, 0.066, 0.087, 0.051),
    ("C", 2): (0.047, 0.053, 0.064, 0.052, 0.067, 0.255),
    ("D", 1): (0.083, 0.078, 0.312, 0.281, 0.311, 0.091),
    ("D", 2): (0.074, 0.073, 0.133, 0.111, 0.130, 0.231),
}
NRMS: Mapping[tuple[str, int], Mapping[str, float]] = {k: dict(zip(METRICS, v)) for k, v in _NRMS.items()}

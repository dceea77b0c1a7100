"""Records (:mod:`febkit.solver.record`, which imports nothing else of febkit)."""

from febkit.solver.record import record, value_record, variable_record

__all__ = ["record", "value_record", "variable_record"]

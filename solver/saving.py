"""Which states are saved (FEBio user manual, plot_level, plot_stride, plot_range)."""

from __future__ import annotations

from .problem import Step


def wanted(step: Step, event: str, count: int, must_point: bool) -> bool:
    """Is the state after ``count`` steps saved at this event: "major", "step" or "solved"?"""
    s = step.saving
    last = step.count if step.duration is None else -1
    lo = s.range[0] + last + 1 if s.range[0] < 0 else s.range[0]
    hi = s.range[1] + last + 1 if s.range[1] < -1 else s.range[1]
    inside = step.auto is not None or (count >= lo and (count <= hi or hi == -1))
    on_stride = (count - lo) % max(s.stride, 1) == 0
    if event == "major":
        return (
            (s.level == "PLOT_MAJOR_ITRS" and inside and (on_stride or must_point))
            or (s.level == "PLOT_MUST_POINTS" and must_point)
            or s.level in ("PLOT_AUGMENTATIONS", "PLOT_MINOR_ITRS")
        )
    if event == "step":
        return s.level == "PLOT_STEP_FINAL"
    return s.level == "PLOT_FINAL" or (s.level == "PLOT_MAJOR_ITRS" and not (inside and on_stride))

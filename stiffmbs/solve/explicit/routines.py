"""Compiled routines of adaptive explicit steps."""

from __future__ import annotations

from ...compile.machine.routines import together

ADVANCE, END_AT_EVENT, FASTEST_RATE = together(
    "stiffmbs.solve.native.runge_kutta",
    advance="int64(float64, int64, int64, int64, int64*)",
    end_at_event="int32(int64*)",
    fastest_rate="float64(float64, int64, float64*, float64*, int64*, int64*)",
)

"""Compiled routines that give a mechanism the form x' = f(t, x), for model exchange."""

from __future__ import annotations

from ...compile.machine.object_code import SHORT
from ...compile.machine.routines import together

CONSISTENT_RATES, EVENT_FUNCTIONS, VIOLATION = together(
    "stiffmbs.solve.explicit.native.state_space",
    SHORT,
    consistent_rates="int64(float64, float64*, float64*, float64*, int64*)",
    event_functions="void(float64, float64*, float64*, int64*, int64*)",
    violation="float64(float64, float64*, int64*)",
)

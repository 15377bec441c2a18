"""Extrapolation of IDA's current state by its rates or accelerations."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, equations_view
from stiffmbs.compile.machine.native.evaluate import load
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.solve.ida.native.ida_memory import array_of


@compiled
def go_straight(c, s, ahead):
    """Load the state in c.y, extrapolated linearly by a time that may be negative."""
    y, yp = array_of(c, c.y), array_of(c, c.yp)
    e = equations_view(c.equations)
    for k in range(e.n):
        c.probe[k] = y[k] + ahead * yp[k]
    load(s, e, c.probe, yp)


@compiled
def go_ahead(c, s, ahead):
    """Load the state in c.y, extrapolated with its accelerations."""
    for k in range(s.n_u):
        s.a[k] = 0.0  # constant coordinates are not loaded
    go_straight(c, s, ahead)
    add_rates(s, s.a, 0.5 * ahead * ahead, s.q)

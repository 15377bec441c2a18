"""The integrator of a simulation by itself: one start after the other, without Python between them."""

from __future__ import annotations

from stiffmbs.solve.error_control.stability_limit import HIGHEST_ORDER
from stiffmbs.solve.ida.native.breakpoints import advance_from


def restarts_in_a_row(count, dt, values, number, table):
    """`count` starts, each of them dt after the one before, with a value each for the number of an element; how many were done."""
    for step in range(count):
        number[0] = values[step]
        if advance_from(step * dt, (step + 1) * dt, HIGHEST_ORDER, table) != 0:
            return step
    return count

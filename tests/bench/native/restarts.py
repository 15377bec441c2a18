"""The integrator of a simulation by itself: one start after the other, without Python between them."""

from __future__ import annotations

from stiffmbs.solve.ida.starting.native.start import restart


def restarts_in_a_row(count, dt, values, number, table):
    """`count` starts, each of them dt after the one before, with a value each for the number of an element; how many were done."""
    for step in range(count):
        number[0] = values[step]
        if restart(step * dt, (step + 1) * dt, table) != 0:
            return step
    return count

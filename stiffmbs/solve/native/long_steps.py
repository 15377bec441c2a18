"""Storage of steps much longer than their predecessors, to be checked after the run."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted, view_of
from stiffmbs.solve.native.tables.steps import LONG_STEPS

long_steps_view = view_of("LongSteps", LONG_STEPS)


@compiled
def is_to_be_kept(w, h):
    """Return True if a step is much longer than its predecessors, and there is space for it."""
    usual = w.usual
    w.usual = usual + (h - usual) / w.remembered
    return h > w.ratio * usual and w.count < w.room


@compiled
def next_row(w, begin, end):
    """Return memory for the states of the next long step; `w.count += 1` stores it."""
    row = shifted(w.row, w.count * (2 + w.n_nodes * w.width))
    row[0] = begin
    row[1] = end
    return shifted(row, 2)


@compiled
def contradicts(h, acceleration, rate, u, mass, rtol, atol, part, tolerances, n_u):
    """Return True if accelerations contradict the rates of a step of length h.

    They must differ by more than a fraction `part` and, over the step, by more than `tolerances` of a velocity.
    """
    off = 0.0
    by_forces = 0.0
    by_rates = 0.0
    most = 0.0
    for k in range(n_u):
        differs = acceleration[k] - rate[k]
        off += mass[k] * differs * differs
        by_forces += mass[k] * acceleration[k] * acceleration[k]
        by_rates += mass[k] * rate[k] * rate[k]
        most = max(most, abs(differs) * h / (atol[k] + rtol * abs(u[k])))
    return not (off <= part * part * max(by_forces, by_rates) or most <= tolerances)

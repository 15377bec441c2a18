"""Storage of steps much longer than their predecessors, to be checked after the run."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted, view_of
from stiffmbs.solve.events.native.layouts import LONG_STEPS

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

"""Steps far longer than those before them, kept with states within them: what they may have passed over is judged after the run."""

from __future__ import annotations

from stiffmbs.compile.machine.layout import LONG_STEPS
from stiffmbs.compile.machine.native.access import compiled, shifted, view_of

long_steps_view = view_of("LongSteps", LONG_STEPS)


@compiled
def is_to_be_kept(w, h):
    """Whether a step is far longer than those before it, and there is room for it."""
    usual = w.usual
    w.usual = usual + (h - usual) / w.remembered
    return h > w.ratio * usual and w.count < w.room


@compiled
def next_row(w, begin, end):
    """Where the states of the next step to be kept belong; it is kept with `w.count += 1`."""
    row = shifted(w.row, w.count * (2 + w.n_nodes * w.width))
    row[0] = begin
    row[1] = end
    return shifted(row, 2)

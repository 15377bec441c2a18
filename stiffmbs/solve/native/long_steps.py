"""Steps far longer than those before them, kept with states within them: what they may have passed over is judged after the run."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted, view_of
from stiffmbs.solve.native.tables.steps import LONG_STEPS

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


@compiled
def contradicts(h, acceleration, rate, u, mass, rtol, atol, part, tolerances, n_u):
    """Whether accelerations differ from the rates of a step of length h by more than a part of them, and, over the step, by more
    than so many tolerances of a velocity."""
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

"""Bound of the step size that resolves the features of inputs, and storage of steps to be checked after the run."""

from stiffmbs.compile.machine.native.access import compiled, shifted, view_of
from stiffmbs.solve.events.native.layouts import STEP_BOUND, WHOLE_STEPS
from stiffmbs.solve.events.native.parameters import SEARCH

STRETCHED = 1.01
"""Factor by which the last step may exceed a bound, to avoid a tiny remainder."""

step_bound_view = view_of("StepBound", STEP_BOUND)


@compiled
def longest_step(f, t):
    """Return the longest step from t that is allowed in all intervals that it touches; f.n is not 0."""
    k = f.place
    while k + 1 < f.n and f.starts[k + 1] <= t:
        k += 1
    while k > 0 and f.starts[k] > t:
        k -= 1
    f.place = k
    h = f.longest[k]
    while k + 1 < f.n and f.starts[k + 1] < t + h:
        k += 1
        h = min(h, max(f.longest[k], f.starts[k] - t))
    return h


@compiled
def distance_to_bend(f, t, h, least):
    """Return the distance, above a least one, from t to the bend in a step of length h; infinity if it passes none, or several.

    A curve with several bends in a step is sampled finely, and left to the error estimate.
    """
    passed = t + max(least, SEARCH.difference * h)
    k = f.bend
    while k < f.n_bends and f.bends[k] <= passed:
        k += 1
    while k > 0 and f.bends[k - 1] > passed:
        k -= 1
    f.bend = k
    end = t + STRETCHED * h
    passes = k < f.n_bends and f.bends[k] < end
    several = k + 1 < f.n_bends and f.bends[k + 1] < end
    return f.bends[k] - t if passes and not several else float("inf")


whole_steps_view = view_of("WholeSteps", WHOLE_STEPS)


@compiled
def next_row(w, begin, end):
    """Return memory for the states of the next step; `w.count += 1` stores it."""
    row = shifted(w.row, w.count * (2 + w.n_nodes * w.width))
    row[0] = begin
    row[1] = end
    return shifted(row, 2)

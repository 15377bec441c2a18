"""Bound of the step size that resolves the features of inputs."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, view_of
from stiffmbs.solve.events.native.layouts import STEP_BOUND

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

"""A little further on behind an event, where the motion goes to the other side of an event function at once."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, state_view
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate
from stiffmbs.compile.machine.native.orientation import take_unit_length
from stiffmbs.solve.native.explicit.stages import copied
from stiffmbs.solve.native.tables.views import dynamics_view

SHORTER, ROUNDINGS = 0.125, 1e-15
"""By how much a shorter way is tried as long as it passes as many event functions, and part of the time that no way is shorter than."""


@compiled
def _passed(s, t, ahead, q, u, rate_q, rate_u, count, values):
    """How many of the first `count` event functions have another sign after going straight on for so long."""
    for k in range(s.n_q):
        s.q[k] = q[k] + ahead * rate_q[k]
    for k in range(s.n_u):
        s.u[k] = u[k] + ahead * rate_u[k]
    take_unit_length(s)
    later = evaluate(s, SWITCH, t + ahead)
    passed = 0
    for k in range(count):
        passed += later[k] != 0.0 and values[k] * later[k] <= 0.0
    return passed


def gone_past(t, most, q, u, rate_q, rate_u, count, values, dynamics):
    """Move the state at hand straight on, for so long at the most, to where event functions that change on that way have changed.

    How long that takes; 0 with the state as it was where none changes.  `values` is memory for those of the event functions.
    """
    s = state_view(dynamics_view(dynamics).state)
    copied(q, s.q, s.n_q)
    copied(u, s.u, s.n_u)
    copied(values, evaluate(s, SWITCH, t), count)
    passed = _passed(s, t, most, q, u, rate_q, rate_u, count, values)
    if passed == 0:
        copied(s.q, q, s.n_q)
        copied(s.u, u, s.n_u)
        return 0.0
    ahead = most
    while (
        ahead * SHORTER > ROUNDINGS * abs(t)
        and _passed(s, t, ahead * SHORTER, q, u, rate_q, rate_u, count, values) == passed
    ):
        ahead *= SHORTER
    _passed(s, t, ahead, q, u, rate_q, rate_u, count, values)
    return ahead

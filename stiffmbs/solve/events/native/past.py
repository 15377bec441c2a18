"""Extrapolation past an event to further sign changes of event functions."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, state_view
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, SWITCH, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates, take_unit_length
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.parameters import SEARCH
from stiffmbs.solve.explicit.native.stages import add_rates_behind


@compiled
def _go(s, m, ahead, q):
    """Extrapolate the positions and states in q linearly by a time, which may be negative."""
    copied(s.q, q, s.n_q)
    add_rates(s, s.u, ahead, s.q)
    add_rates_behind(s, m, ahead, s.q)
    take_unit_length(s)


@compiled
def _passed(s, m, t, ahead, q, count, values):
    """Return the number of the first `count` event functions that change sign within a linear extrapolation from q."""
    _go(s, m, ahead, q)
    later = evaluate(s, SWITCH, t + ahead)
    passed = 0
    for k in range(count):
        passed += later[k] != 0.0 and values[k] * later[k] <= 0.0
    return passed


@compiled
def moved_past(s, m, t, most, count, q, values):
    """Extrapolate the current state past sign changes of event functions within the time `most`.

    Returns the time, 0 with the state unchanged for none.  Memory: `q` for positions, `values` for event functions.
    """
    copied(q, s.q, s.n_q)
    if m.n_behind > 0:
        evaluate(s, ACCELERATION, t)
    _go(s, m, -most, q)  # at the state itself, rounding decides the signs
    copied(values, evaluate(s, SWITCH, t - most), count)
    passed = _passed(s, m, t, most, q, count, values)
    if passed == 0:
        copied(s.q, q, s.n_q)
        return 0.0
    ahead = most
    while (
        ahead * SEARCH.shorter > SEARCH.rounding * abs(t)
        and _passed(s, m, t, ahead * SEARCH.shorter, q, count, values) == passed
    ):
        ahead *= SEARCH.shorter
    ahead = min(ahead / (SEARCH.shorter * SEARCH.shorter), most)  # closer, rounding may show the change too early
    _passed(s, m, t, ahead, q, count, values)
    return ahead


def gone_past(t, most, count, q, values, dynamics):
    """Call `moved_past` from Python."""
    m = dynamics_view(dynamics)
    return moved_past(state_view(m.state), m, t, most, count, q, values)

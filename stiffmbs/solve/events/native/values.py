"""Event functions at the current state."""

from math import floor

from stiffmbs.compile.machine.native.access import compiled, ints, state_view
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.dynamics.native.consistent import consistent_accelerations
from stiffmbs.dynamics.native.views import dynamics_view


@compiled
def take_reactions(w, s, t):
    """Compute the multipliers and algebraic states that event functions need from accelerations at the current state.

    Those of an integrator have no error test, and contain the remainder of Newton's iteration, multipliers divided by
    the step: restarts, which compute both, would meet an event again that the integrator has passed.
    """
    if w.by_accelerations:
        m = dynamics_view(ints(w.dynamics))
        copied(w.lam, s.lam, w.n_lam)
        if consistent_accelerations(state_view(m.state), m, t) < 0:
            copied(s.lam, w.lam, w.n_lam)


@compiled
def switches(w, s, t):
    """Return the event functions at the current state."""
    take_reactions(w, s, t)
    return unwrapped(w, evaluate(s, SWITCH, t))


@compiled
def unwrapped(w, values):
    """Return values without the jumps of directions by periods of their tables since the start of the step."""
    for i in range(w.n_jumping):
        k = w.jumping[i]
        change = values[k] - w.value_before[k]
        if abs(change) > 0.5 * w.period[k]:
            values[k] -= w.period[k] * floor(change / w.period[k] + 0.5)
    return values

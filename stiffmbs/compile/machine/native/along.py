"""Derivatives of all terms of a set in a direction (`stiffmbs.compile.directional`)."""

from .access import call_kernel, compiled, floats, ints, room, shifted, state_view, view_of, with_derivative
from .orientation import N_Q, TURN_STRIDE, share_orientation
from .tables import CALL, DIRECTION

CALL_WIDTH = len(CALL) + 1
TURNED = N_Q * TURN_STRIDE
"""Shared orientation values of a spatial body."""

direction_view = view_of("Direction", DIRECTION)


@compiled
def evaluate_along(s, d, t, t_d):
    """Compute the term derivatives of a direction at the state in `s` with its shared orientation values."""
    shared = room(TURNED)
    for k in range(d.n_turned):
        at = d.turned[k]
        if s.spatial:
            p = with_derivative(shifted(s.q, at + 3), shifted(d.q, at + 3))
            share_orientation(p, with_derivative(shared, shifted(d.turn, TURN_STRIDE * at)))
        else:
            d.turn[at] = -s.turn[at + 1] * d.q[at + 2]
            d.turn[at + 1] = s.turn[at] * d.q[at + 2]
    for k in range(d.n_calls):
        at = CALL_WIDTH * k
        call_kernel(
            d.calls[at], d.calls[at + 1], ints(d.calls[at + 2]), floats(d.calls[at + 3]),
            t, s.q, s.turn, s.u, s.a, s.lam, s.mu, ints(d.calls[at + 4]), d.terms,
            floats(d.calls[at + 5]), t_d, d.q, d.turn, d.u, d.a, d.lam, d.mu, d.values,
        )  # fmt: skip


def along(t, t_d, state, direction):
    """Call `evaluate_along` from Python, after evaluation of the terms themselves."""
    evaluate_along(state_view(state), direction_view(direction), t, t_d)

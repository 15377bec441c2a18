"""Derivatives of all terms of a set in a direction (`stiffmbs.compile.directional`)."""

from .access import call_kernel, compiled, floats, ints, shifted, state_view, view_of
from .orientation import TURN_STRIDE
from .tables import CALL, DIRECTION

CALL_WIDTH = len(CALL) + 1

direction_view = view_of("Direction", DIRECTION)


@compiled
def _share_moved(p, moved, turn):
    """Differentiate `share_orientation` by the product rule."""
    square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]
    n = 2.0 / square
    n_d = -n * n * (p[0] * moved[0] + p[1] * moved[1] + p[2] * moved[2] + p[3] * moved[3])
    e0, e1, e2, e3 = n * p[0], n * p[1], n * p[2], n * p[3]
    d0, d1 = n_d * p[0] + n * moved[0], n_d * p[1] + n * moved[1]
    d2, d3 = n_d * p[2] + n * moved[2], n_d * p[3] + n * moved[3]
    w = d0 * p[0] + e0 * moved[0]
    turn[0] = w + d1 * p[1] + e1 * moved[1]
    turn[4] = w + d2 * p[2] + e2 * moved[2]
    turn[8] = w + d3 * p[3] + e3 * moved[3]
    xy, zw = d1 * p[2] + e1 * moved[2], d0 * p[3] + e0 * moved[3]
    xz, yw = d1 * p[3] + e1 * moved[3], d0 * p[2] + e0 * moved[2]
    yz, xw = d2 * p[3] + e2 * moved[3], d0 * p[1] + e0 * moved[1]
    turn[1] = xy - zw
    turn[2] = xz + yw
    turn[3] = xy + zw
    turn[5] = yz - xw
    turn[6] = xz - yw
    turn[7] = yz + xw
    turn[9] = d0
    turn[10] = d1
    turn[11] = d2
    turn[12] = d3
    turn[13] = n_d


@compiled
def evaluate_along(s, d, t, t_d):
    """Compute the term derivatives of a direction at the state in `s` with its shared orientation values."""
    for k in range(d.n_turned):
        at = d.turned[k]
        if s.spatial:
            _share_moved(shifted(s.q, at + 3), shifted(d.q, at + 3), shifted(d.turn, TURN_STRIDE * at))
        else:
            d.turn[at] = -s.turn[at + 1] * d.q[at + 2]
            d.turn[at + 1] = s.turn[at] * d.q[at + 2]
    for k in range(d.n_calls):
        at = CALL_WIDTH * k
        call_kernel(
            d.calls[at], d.calls[at + 1], ints(d.calls[at + 2]), floats(d.calls[at + 3]),
            t, s.q, s.turn, s.u, s.a, s.lam, s.mu, ints(d.calls[at + 4]), d.values,
            floats(d.calls[at + 5]), t_d, d.q, d.turn, d.u, d.a, d.lam, d.mu,
        )  # fmt: skip


def along(t, t_d, state, direction):
    """Call `evaluate_along` from Python, after evaluation of the terms themselves."""
    evaluate_along(state_view(state), direction_view(direction), t, t_d)

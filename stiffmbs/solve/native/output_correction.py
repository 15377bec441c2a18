"""Interpolated states of stiff scenes, brought back to the equations.

IDA's interpolant takes each unknown for itself.  Where a step is long against the stiffest oscillation, what that leaves
in a position makes a force far beyond the forces there are.  Newton's iteration
    M delta = F(t, y, y'),  y -= delta,  y' -= cj delta,  M = dF/dy + cj dF/dy'
restores the equilibrium of stiff forces.  The factors of IDA's last step serve no longer where a body has turned by a small
angle since then, as stiff directions turn with it; so this iteration has factors of its own, kept while they serve.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, state_view, view_of
from stiffmbs.compile.machine.native.evaluate import add_entries, add_products, add_sizes, evaluate, load
from stiffmbs.solve.native.block_systems import to_position_constraints
from stiffmbs.solve.native.calls import call_int, copy_bytes, int32
from stiffmbs.solve.native.explicit.stages import copied
from stiffmbs.solve.native.statuses import OK
from stiffmbs.solve.native.tables.steps import OUTPUT_CORRECTION
from stiffmbs.solve.native.tables.views import dynamics_view

APART = 2.0
"""Factor between cj of the factors and IDA's beyond which they are made anew: accelerations would change too much, or too little."""
MOST_CORRECTIONS = 8
"""Corrections."""
SLOWEST = 0.3
"""A correction that is a larger part of the one before asks for new factors, or ends the iteration in vain."""

CLOSED, MOST_MOVES = 1e-12, 20
"""As reports close joints (`stiffmbs.solve.dynamics.Dynamics.report`)."""

FAR_BELOW, MOST_UNSEEN = 0.2, 7
"""Part of the force that may be left below which, in the middle of a step, some states after this one are not looked at, and their number at
the most."""

TRUSTED = 10
"""States for which a measured rate serves, or what closing joints makes."""
WORSE = 3.0
"""Times the measured figure that is reckoned with: it hangs on the direction of what is left."""
INFINITE = float("inf")

output_correction_view = view_of("OutputCorrection", OUTPUT_CORRECTION)


@compiled
def _interpolated(b, t):
    """Take y and y' from IDA's interpolant."""
    if call_int(b.interpolate, (b.memory, t, int32(0), b.at_y)) < OK:
        return False
    return call_int(b.interpolate, (b.memory, t, int32(1), b.at_yp)) >= OK


@compiled
def _factored(b, s, e, t):
    """Factor M at the state at hand."""
    b.factored = 0.0
    cj = b.current
    call_int(b.clear, (b.matrix,))
    load(s, e, b.y, b.yp)
    add_entries(e, evaluate(s, e.matrix_set, t), cj, floats(b.entries))
    for k in range(0, 6, 3):
        copy_bytes(b.pattern[k], b.pattern[k + 1], b.pattern[k + 2])
    if call_int(b.setup, (b.solver, b.matrix)) != OK:
        return False
    b.factored = cj
    b.made = t
    b.growth = -1.0
    return True


@compiled
def _look(b, s, e, t):
    """What the equations leave at the state at hand."""
    load(s, e, b.y, b.yp)
    add_products(e, evaluate(s, e.residual_set, t), b.y, b.yp, b.defect)
    add_sizes(e, floats(s.values[e.residual_set]), b.y, b.yp, b.size)


@compiled
def _unbalanced(b, defect):
    """The largest part that the equations of motion leave of the forces in them, in units of what may be left."""
    part = 0.0
    first = 0
    for kind in range(2):
        largest = 0.0
        left = 0.0
        for k in range(first, b.force_end[kind]):
            largest = max(largest, b.size[b.force_row[k]])
            left = max(left, abs(defect[b.force_row[k]]))
        first = b.force_end[kind]
        if left > 0.0:
            part = max(part, left / (b.balanced * largest))
    return part


@compiled
def _by_closing(b, s, e, t, opening):
    """The same where joints are closed, by a move that knows nothing of stiff forces; notes what it changes for an opening."""
    copied(b.pose, s.q, s.n_q)
    if to_position_constraints(s, dynamics_view(b.dynamics), t, CLOSED, MOST_MOVES) < 0:
        copied(s.q, b.pose, s.n_q)
        return INFINITE
    add_products(e, evaluate(s, e.residual_set, t), b.y, b.yp, b.correction)
    copied(s.q, b.pose, s.n_q)
    part = _unbalanced(b, b.correction)
    for k in range(e.n):
        b.correction[k] -= b.defect[k]
    b.local = _unbalanced(b, b.correction) / opening
    b.judged = TRUSTED
    return part


@compiled
def _left(b, s, e, t):
    """The largest part that the equations of motion leave of the forces in them, also as reported: with joints closed.

    What closing them makes is computed where the last figure for it is old, or near to what may be left.
    """
    part = _unbalanced(b, b.defect)
    opening = 0.0
    for k in range(b.n_joint_rows):
        opening = max(opening, abs(b.defect[b.joint_row[k]]))
    if part > 1.0 or opening <= CLOSED:
        return part
    if b.judged > 0 and WORSE * b.local * opening <= 1.0:
        b.judged -= 1
        return max(part, WORSE * b.local * opening)
    return max(part, _by_closing(b, s, e, t, opening))


@compiled
def _is_balanced(b, s, e, t, ahead):
    """Whether the forces of the interpolated state balance well enough; settles how many states after it are not looked at.

    Interpolants are exact at both ends of a step, so what is left near them says little of other states.
    """
    middle = 4.0 * ahead * (1.0 - ahead)
    part = _left(b, s, e, t)
    b.unseen = min(2 * b.unseen + 1, MOST_UNSEEN) if part < FAR_BELOW * middle else 0
    b.next_look = b.unseen
    return part <= 1.0


@compiled
def _corrected(b, e):
    """Make one correction; returns its size in units of the tolerance."""
    call_int(b.solve, (b.solver, b.matrix, b.at_correction, b.at_defect, 0.0))
    cj = b.factored
    squares = 0.0
    for k in range(e.n):
        b.y[k] -= b.correction[k]
        b.yp[k] -= cj * b.correction[k]
        part = b.correction[k] * b.weight[k]
        squares += part * part
    return (squares / e.n) ** 0.5


@compiled
def _predicted(b, t):
    """The rate for the first correction: as bodies turn away from where the factors were made; 1 where it has to be measured."""
    b.since += 1
    known = b.growth >= 0.0 and b.since <= TRUSTED
    return WORSE * b.growth * (t - b.made) if known else 1.0


@compiled
def _note_rate(b, t, rate):
    """Where the factors are new, the iteration converges quadratically, which says nothing of later states."""
    if t > b.made:
        b.growth = rate / (t - b.made)
        b.since = 0


@compiled
def _settled(b, s, e, t):
    """Correct until what is left makes no force that counts, by the rate at which corrections shrink or by the balance of forces."""
    rate = _predicted(b, t)
    before = 0.0
    for k in range(MOST_CORRECTIONS):
        size = _corrected(b, e)
        if k > 0:
            rate = size / before
            if not rate < SLOWEST:
                return size <= b.enough
            _note_rate(b, t, rate)
        if rate * size <= b.enough:
            return True
        before = size
        _look(b, s, e, t)
        if _left(b, s, e, t) <= 1.0:
            return True
    return False


@compiled
def corrected(output_correction, state, equations, t, ahead):
    """Interpolate, and bring the state, held in the table's y and y', back to the equations; False where it stays as it is interpolated.

    `ahead` is the part of the step that is ahead of t.
    """
    b = output_correction_view(output_correction)
    if b.next_look > 0:
        b.next_look -= 1
        return False
    s = state_view(state)
    e = equations_view(equations)
    if not _interpolated(b, t):
        return False
    _look(b, s, e, t)
    if _is_balanced(b, s, e, t, ahead):
        return True
    if call_int(b.weights, (b.memory, b.at_weight)) < OK:
        return False
    if b.current / APART < b.factored < b.current * APART:
        if _settled(b, s, e, t):
            return True
        _interpolated(b, t)
        _look(b, s, e, t)
    return _factored(b, s, e, t) and _settled(b, s, e, t)

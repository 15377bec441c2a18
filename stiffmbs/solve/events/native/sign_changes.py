"""Event functions near a state: their sign changes on both sides and ahead, accelerations there, and rates."""

from stiffmbs.compile.machine.native.access import compiled, factors_view, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, SWITCH, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates, take_unit_length
from stiffmbs.dynamics.native.consistent import consistent_accelerations
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.parameters import INDISTINCT, SEARCH
from stiffmbs.solve.explicit.native.stages import add_trailing_rates


@compiled
def _take(s, size, q, u, along_q, along_u):
    """Move the state along a direction, each number in proportion to its size, at least 1."""
    for k in range(s.n_q):
        s.q[k] = q[k] + size * max(1.0, abs(q[k])) * along_q[k]
    for k in range(s.n_u):
        s.u[k] = u[k] + size * max(1.0, abs(u[k])) * along_u[k]


@compiled
def _event_functions(s, m, t):
    """Return the event functions at the current state, with its algebraic states and multipliers if these are found."""
    if m.n_algebraic > 0 or m.switches_by_reactions:
        consistent_accelerations(s, m, t)
    return evaluate(s, SWITCH, t)


def switches(t, size, q, u, along_q, along_u, count, values, dynamics):
    """Store the first `count` event functions at a moved state in `values`."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    _take(s, size, q, u, along_q, along_u)
    copied(values, _event_functions(s, m, t), count)


@compiled
def _changes(s, m, t, size, q, u, along_q, along_u, count, moved, change):
    """Compute the median of three changes of event functions within a move from -2 to 2 sizes.

    A jump, where another function vanishes, is in one of the three.  `moved` is memory of shape (4, count).
    """
    for k in range(4):
        _take(s, size * (k - 2 if k < 2 else k - 1), q, u, along_q, along_u)
        copied(shifted(moved, k * count), _event_functions(s, m, t), count)
    for k in range(count):
        before = 2.0 * abs(moved[count + k] - moved[k])
        here = abs(moved[2 * count + k] - moved[count + k])
        after = 2.0 * abs(moved[3 * count + k] - moved[2 * count + k])
        change[k] = max(min(before, here), min(max(before, here), after))


@compiled
def _one_way(moved, k, count):
    """Return True if an event function changes in one direction within the last move of `_changes`."""
    here = moved[2 * count + k] - moved[count + k]
    before = (moved[count + k] - moved[k]) * here
    return before > 0.0 and here * (moved[3 * count + k] - moved[2 * count + k]) > 0.0


@compiled
def _stored(s, kept):
    """Store the state from which integrators continue."""
    copied(kept, s.q, s.n_q)
    copied(shifted(kept, s.n_q), s.u, s.n_u)
    copied(shifted(kept, s.n_q + s.n_u), s.a, s.n_u)
    copied(shifted(kept, s.n_q + 2 * s.n_u), s.lam, s.n_c)
    copied(shifted(kept, s.n_q + 2 * s.n_u + s.n_c), s.mu, s.n_c)


@compiled
def _restored(s, kept):
    """Restore what `_stored` has stored."""
    copied(s.q, kept, s.n_q)
    copied(s.u, shifted(kept, s.n_q), s.n_u)
    copied(s.a, shifted(kept, s.n_q + s.n_u), s.n_u)
    copied(s.lam, shifted(kept, s.n_q + 2 * s.n_u), s.n_c)
    copied(s.mu, shifted(kept, s.n_q + 2 * s.n_u + s.n_c), s.n_c)


def crossed(t, size, q, u, along_q, along_u, count, found, kept, values, dynamics):
    """Mark the first `count` event functions with different signs on both sides of a move that depend on velocities.

    Return their number.  The state is unchanged in the end.  Memory: `kept` for a state, `values` for event functions.
    """
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    _stored(s, kept)
    total = _opposite(s, m, t, size, q, u, along_q, along_u, count, found)
    if total > 0:
        total = _of_velocities(s, m, t, size, q, u, along_u, count, values, found)
    _restored(s, kept)
    return total


@compiled
def _opposite(s, m, t, size, q, u, along_q, along_u, count, found):
    """Mark the first `count` event functions with different signs on both sides of a move; return their number."""
    _take(s, size, q, u, along_q, along_u)
    values = _event_functions(s, m, t)
    for k in range(count):
        found[k] = (values[k] > 0.0) - (values[k] < 0.0)
    _take(s, -size, q, u, along_q, along_u)
    values = _event_functions(s, m, t)
    total = 0
    for k in range(count):
        opposite = (values[k] > 0.0) - (values[k] < 0.0)
        found[k] = found[k] * opposite < 0
        total += found[k]
    return total


@compiled
def _of_velocities(s, m, t, size, q, u, along_u, count, values, found):
    """Remove the marks of event functions that do not depend on velocities; return the number of the others."""
    copied(s.q, q, s.n_q)
    for k in range(s.n_u):
        s.u[k] = u[k] + size * max(1.0, abs(u[k])) * along_u[k]
    copied(values, _event_functions(s, m, t), count)
    copied(s.u, u, s.n_u)
    here = _event_functions(s, m, t)
    total = 0
    for k in range(count):
        found[k] = found[k] and here[k] != values[k]
        total += found[k]
    return total


def noise(t, precision, rtol, q, u, along_q, along_u, still, count, kept, moved, here, found, slow, dynamics):
    """Compute event functions and their changes by a move of the size of rounding, the first `count` ones, at a state.

    Functions of multipliers change by a move of the relative tolerance, as stiff forces amplify errors.  `slow` has the changes by a
    move of velocities of that size, negative for functions that do not change in one direction.  The state is unchanged in the end.
    `kept` is memory for a state, `moved` of shape (4, count).
    """
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    _stored(s, kept)
    copied(s.q, q, s.n_q)
    copied(s.u, u, s.n_u)
    copied(here, evaluate(s, SWITCH, t), count)
    _changes(s, m, t, precision, q, u, along_q, along_u, count, moved, found)
    if m.switches_by_reactions:
        _changes(s, m, t, rtol, q, u, along_q, along_u, count, moved, slow)
        copied(moved, evaluate(s, SWITCH, t), count)
        for k in range(s.n_c):
            s.lam[k] += 1.0
        pressed = evaluate(s, SWITCH, t)
        for k in range(count):
            if pressed[k] != moved[k]:
                found[k] = max(found[k], slow[k])
    _changes(s, m, t, rtol, q, u, still, along_u, count, moved, slow)
    for k in range(count):
        if not _one_way(moved, k, count):
            slow[k] = -1.0
    _restored(s, kept)


def of_states(n, t, q, u, count, values, dynamics):
    """Store the first `count` event functions of n states in the rows of `values`."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    for i in range(n):
        copied(s.q, shifted(q, i * s.n_q), s.n_q)
        copied(s.u, shifted(u, i * s.n_u), s.n_u)
        copied(shifted(values, i * count), _event_functions(s, m, t[i]), count)


def side(t, size, interval, q, u, along_q, along_u, there, count, values, acceleration, rates, dynamics):
    """Compute event functions, accelerations and rates over an interval of time at a moved state.

    Returns a negative status if there are no accelerations.  `there` is memory for coordinates.
    """
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    _take(s, size, q, u, along_q, along_u)
    copied(values, _event_functions(s, m, t), count)
    copied(there, s.q, s.n_q)
    add_rates(s, s.u, interval, there)
    status = consistent_accelerations(s, m, t)
    if status < 0:
        return status
    copied(acceleration, factors_view(m.acceleration_factors).b, s.n_u)
    copied(s.q, there, s.n_q)
    take_unit_length(s)
    for k in range(s.n_u):
        s.u[k] += interval * acceleration[k]
    ahead = _event_functions(s, m, t + interval)
    for k in range(count):
        rates[k] = (ahead[k] - values[k]) / interval
    return status


@compiled
def _go(s, m, ahead, q):
    """Extrapolate the positions and states in q linearly by a time, which may be negative."""
    copied(s.q, q, s.n_q)
    add_rates(s, s.u, ahead, s.q)
    add_trailing_rates(s, m, ahead, s.q)
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
    if m.n_trailing > 0:
        evaluate(s, ACCELERATION, t)
    _go(s, m, -most, q)  # at the state itself, rounding decides the signs
    copied(values, evaluate(s, SWITCH, t - most), count)
    passed = _passed(s, m, t, most, q, count, values)
    if passed == 0:
        copied(s.q, q, s.n_q)
        return 0.0
    ahead = most
    while (
        ahead > SEARCH.longer * INDISTINCT * abs(t)
        and _passed(s, m, t, ahead / SEARCH.longer, q, count, values) == passed
    ):
        ahead /= SEARCH.longer
    ahead = min(ahead * SEARCH.longer * SEARCH.longer, most)  # closer, rounding may show the change too early
    _passed(s, m, t, ahead, q, count, values)
    return ahead


@compiled
def taken_back(s, m, t, ahead, count, q, here, values, found):
    """Mark event functions that change sign at t by the positions q, and whose change the current state is still before.

    Return their number.  A mark is the sign after the change.  The current velocities belong to both.  Memory: `here`
    for positions, `values` for event functions.
    """
    copied(here, s.q, s.n_q)
    if m.n_trailing > 0:
        evaluate(s, ACCELERATION, t)
    _go(s, m, -ahead, q)
    copied(values, evaluate(s, SWITCH, t - ahead), count)
    _go(s, m, ahead, q)
    after = evaluate(s, SWITCH, t + ahead)
    for k in range(count):
        found[k] = (after[k] > 0.0) - (after[k] < 0.0) if values[k] * after[k] < 0.0 else 0
    total = _before(s, m, t, ahead, here, count, found)
    copied(s.q, here, s.n_q)
    return total


@compiled
def _before(s, m, t, ahead, q, count, found):
    """Return the number of marked event functions without the sign of their mark after a linear extrapolation from q."""
    _go(s, m, ahead, q)
    later = evaluate(s, SWITCH, t + ahead)
    total = 0
    for k in range(count):
        total += found[k] * later[k] < 0.0
    return total


@compiled
def until_changed(s, m, t, ahead, longest, count, here, found):
    """Return the time from `ahead` to `longest` in which most marked event functions change; `ahead` if none does.

    The state is extrapolated linearly, and is unchanged in the end.  Memory: `here` for positions.
    """
    copied(here, s.q, s.n_q)
    if m.n_trailing > 0:
        evaluate(s, ACCELERATION, t)
    least = _before(s, m, t, ahead, here, count, found)
    best = ahead
    time = ahead
    while least > 0 and time < longest:
        time = min(SEARCH.longer * time, longest)
        left = _before(s, m, t, time, here, count, found)
        if left < least:
            least = left
            best = time
    copied(s.q, here, s.n_q)
    return best

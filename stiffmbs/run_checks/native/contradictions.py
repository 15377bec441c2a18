"""Output rows between which velocity changes contradict the accelerations."""

from stiffmbs.compile.machine.native.access import compiled, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import POSITION, evaluate


@compiled
def _weighted(count, n_u, acceleration, mass):
    """Return the square of the first acceleration, weighted with masses."""
    total = 0.0
    for k in range(n_u):
        total += mass[k] * acceleration[k * count] * acceleration[k * count]
    return total


@compiled
def _larger(first, second):
    """Return the larger of two numbers, ignoring a NaN."""
    return first if first >= second or second != second else second


@compiled
def _within_step(begin, end, n_steps, steps):
    """Return True if an interval lies strictly inside one of the steps with the given ends."""
    low, high = 0, n_steps
    while low < high:
        middle = (low + high) // 2
        if steps[middle] <= begin:
            low = middle + 1
        else:
            high = middle
    return low > 0 and low < n_steps and steps[low - 1] < begin and end < steps[low]


def contradicting_rows(count, n_u, t, u, acceleration, mass, part, least, n_steps, steps, found):
    """Store the rows that contradict the next one within a step in `found`, and return their number.

    In such a row the mean rate of the velocities differs from the mean acceleration by more than `part` of the larger one.
    The difference in a velocity is also more than its number in `least`. `u` and `acceleration`: columns of `count` numbers.
    """
    contradicting = 0
    before = _weighted(count, n_u, acceleration, mass) if count > 0 else 0.0
    for row in range(count - 1):
        first, velocity = shifted(acceleration, row), shifted(u, row)
        per_second = 1.0 / (t[row + 1] - t[row])
        total = 0.0
        exceeds = False
        for k in range(n_u):
            at = k * count
            off = (velocity[at + 1] - velocity[at]) * per_second - 0.5 * (first[at] + first[at + 1])
            total += mass[k] * off * off
            if abs(off) > least[k]:
                exceeds = True
        after = _weighted(count, n_u, shifted(first, 1), mass)
        if (
            exceeds
            and total > part * part * _larger(after, before)
            and _within_step(t[row], t[row + 1], n_steps, steps)
        ):
            found[contradicting] = row
            contradicting += 1
        before = after
    return contradicting


def apart_from_counters(count, n_q, t, q, n_counters, source, row, apart, state):
    """Write the distances of angles (position terms) from their counters to `apart`, for `count` coordinate rows."""
    s = state_view(state)
    for k in range(count):
        pose = shifted(q, k * n_q)
        for i in range(n_q):
            s.q[i] = pose[i]
        values = evaluate(s, POSITION, t[k])
        for i in range(n_counters):
            apart[k * n_counters + i] = abs(values[source[i]] - pose[row[i]])

"""Work of a power given at output instants, and numbers of solver steps between these."""

from stiffmbs.compile.machine.native.access import compiled, shifted


@compiled
def _slope(t, power, k, count, apart):
    """Return the derivative at an instant by a parabola through its neighbours, or by a line at the ends."""
    here, left, right = apart * k, apart * (k - 1), apart * (k + 1)
    if k == 0:
        return (power[right] - power[here]) / (t[right] - t[here])
    if k == count - 1:
        return (power[here] - power[left]) / (t[here] - t[left])
    before, after = t[here] - t[left], t[right] - t[here]
    rise, following = (power[here] - power[left]) / before, (power[right] - power[here]) / after
    return (rise * after + following * before) / (before + after)


@compiled
def _gained(t, power, k, count, apart, within):
    """Return the work up to the next instant by the trapezoidal rule with end corrections (`within`)."""
    here, right = apart * k, apart * (k + 1)
    h = t[right] - t[here]
    within[0] = 0.0
    if count > 2:
        within[0] = h * h * (_slope(t, power, k, count, apart) - _slope(t, power, k + 1, count, apart)) / 12.0
    return h * (power[here] + power[right]) / 2.0 + within[0]


def work(count, t, power, total, within):
    """Write the work and end corrections; return the largest difference from the work of every other instant."""
    total[0] = 0.0
    fewer = (count + 1) // 2
    coarse = 0.0
    largest = 0.0
    for k in range(count - 1):
        if k % 2 == 1:  # this correction is overwritten below
            coarse += _gained(t, power, k // 2, fewer, 2, shifted(within, k))
        total[k + 1] = total[k] + _gained(t, power, k, count, 1, shifted(within, k))
        if k % 2 == 1:
            largest = max(largest, abs(total[k + 1] - coarse))
    return largest


def steps_inside(count, t, n_steps, steps, inside):
    """Write the number of steps that end strictly inside each interval between `count` instants."""
    before, until = 0, 0
    for k in range(count - 1):
        while before < n_steps and steps[before] <= t[k]:
            before += 1
        while until < n_steps and steps[until] < t[k + 1]:
            until += 1
        inside[k] = until - before

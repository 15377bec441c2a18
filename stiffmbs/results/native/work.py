"""Work of a power given at output instants."""

from stiffmbs.compile.machine.native.access import compiled


@compiled
def _slope(t, power, k, count):
    """Return the derivative at an instant by a parabola through its neighbours, or by a line at the ends."""
    if k == 0:
        return (power[1] - power[0]) / (t[1] - t[0])
    if k == count - 1:
        return (power[k] - power[k - 1]) / (t[k] - t[k - 1])
    before, after = t[k] - t[k - 1], t[k + 1] - t[k]
    rise, following = (power[k] - power[k - 1]) / before, (power[k + 1] - power[k]) / after
    return (rise * after + following * before) / (before + after)


def work(count, t, power, total):
    """Write the work since the first instant by the trapezoidal rule with end corrections."""
    total[0] = 0.0
    for k in range(count - 1):
        h = t[k + 1] - t[k]
        gained = h * (power[k] + power[k + 1]) / 2.0
        if count > 2:
            gained += h * h * (_slope(t, power, k, count) - _slope(t, power, k + 1, count)) / 12.0
        total[k + 1] = total[k] + gained

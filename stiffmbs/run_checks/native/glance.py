"""Scan of the output rows in one pass."""

from __future__ import annotations

from math import isfinite

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.results.native.work import work
from stiffmbs.run_checks.native.contradictions import contradicting_rows


@compiled
def _all_finite(count, values):
    """Return True if all numbers are finite, by four partial sums, or one by one if these overflow."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    whole = count - count % 4
    for k in range(0, whole, 4):
        a += values[k]
        b += values[k + 1]
        c += values[k + 2]
        d += values[k + 3]
    for k in range(whole, count):
        a += values[k]
    if isfinite(a + b + c + d):
        return True
    finite = True
    for k in range(count):
        finite = finite and isfinite(values[k])
    return finite


@compiled
def _width(count, values):
    """Return the range of some numbers and zero."""
    low, high, other_low, other_high = 0.0, 0.0, 0.0, 0.0  # in two independent parts
    whole = count - count % 4
    for k in range(0, whole, 4):
        a, b, c, d = values[k], values[k + 1], values[k + 2], values[k + 3]
        low, high = min(low, min(a, b)), max(high, max(a, b))
        other_low, other_high = min(other_low, min(c, d)), max(other_high, max(c, d))
    for k in range(whole, count):
        low, high = min(low, values[k]), max(high, values[k])
    return max(high, other_high) - min(low, other_low)


@compiled
def _energies(count, t, kinetic, potential, power, keeps_energy, done, within, found):
    """Write the exchanged energy and the largest error of its balance (total, or in one interval) to `found`."""
    if not keeps_energy:
        work(count, t, power, done, within)
    most_kinetic = 0.0
    low, high = potential[0], potential[0]
    least, most = 0.0, 0.0
    furthest, before = 0.0, 0.0
    for k in range(count):
        gained = 0.0 if keeps_energy else done[k]
        missing = (kinetic[k] + potential[k]) - (kinetic[0] + potential[0]) - gained
        furthest = max(furthest, abs(missing), abs(missing - before))
        before = missing
        most_kinetic = max(most_kinetic, kinetic[k])
        low, high = min(low, potential[k]), max(high, potential[k])
        least, most = min(least, gained), max(most, gained)
    found[0] = max(most_kinetic, high - low, most - least)
    found[1] = furthest


def glance(
    count, n_q, n_u, n_values, t, q, u, acceleration, values, mass, kinetic, potential, power, keeps_energy, part, n_steps, steps,
    done, within, contradicting, found,
):  # fmt: skip
    """Write the energy, error of its balance, widths and contradicting rows to `found`; return 0 for unusable rows."""
    for k in range(count):
        if not isfinite(kinetic[k] + potential[k] + power[k]) or (k > 0 and not t[k] > t[k - 1]):
            return 0
    if not (_all_finite(count * n_q, q) and _all_finite(count * n_u, u)):
        return 0
    if not (_all_finite(count * n_u, acceleration) and _all_finite(count * n_values, values)):
        return 0
    _energies(count, t, kinetic, potential, power, keeps_energy, done, within, found)
    found[2] = _width(count * n_q, q)
    found[3] = _width(count * n_u, u)
    found[4] = contradicting_rows(count, n_u, t, u, acceleration, mass, part, n_steps, steps, contradicting)
    return 1

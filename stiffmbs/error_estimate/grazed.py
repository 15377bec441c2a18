"""Forces beyond a kink that a run does not reach by its own error, such as those of a contact that is barely touched.

The error e of the states z follows e' = F(z) - F(z - e) + d, and its transport takes J e + d. Where z stays before a kink and z - e is
beyond it, F(z) - F(z - e) - J e is the force that is missed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compile.law_intervals import has_kinks
from ..dynamics.dynamics import Dynamics
from ..solve.events.discontinuity import distances_from_kinks
from ..solve.events.native.parameters import BISECTIONS
from .coordinates import displaced
from .evaluated import Evaluated, evaluated, motion
from .kinks import GAUSS_NODES, GAUSS_WEIGHTS, Curve
from .parameters import ESTIMATE

PLACES = np.linspace(0.0, 1.0, 9)
"""Places in an interval at which a least distance is searched, again and again."""
SEARCHES = int(np.ceil(np.log(np.finfo(float).eps) / (2.0 * np.log(PLACES[2]))))
"""Searches, each between the neighbours of the last least distance: rounding lets an extremum be located to the root of its unit."""


@dataclass(frozen=True, eq=False)
class _Curves:
    """States of a run between its rows, and with them those without the errors.

    - `t`: times of the rows, s. `errors` of shape (rows, full), in between which they are interpolated.
    """

    dynamics: Dynamics
    t: np.ndarray
    errors: np.ndarray
    curve: Curve

    @classmethod
    def through(cls, dynamics: Dynamics, at: Evaluated, errors: np.ndarray) -> _Curves:
        """Return the curves through states and their rates."""
        z, rates = np.hstack([at.q, at.u]), np.hstack([at.q_rates, at.acceleration])
        pairs = np.arange(len(at.t) - 1)[:, None] + np.arange(2)
        return cls(dynamics, at.t, errors, Curve.of_ends(at.t[pairs], z[pairs], rates[pairs]))

    def states(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return q and u, projected onto the constraints, and errors at some times, shape (n,)."""
        k = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        part = (t - self.t[k]) / (self.t[k + 1] - self.t[k])
        _, z = self.curve.at(part[:, None], k)
        errors = self.errors[k] + part[:, None] * (self.errors[k + 1] - self.errors[k])
        q, u = np.hsplit(z, [self.dynamics.system.n_q])
        q, u = displaced(self.dynamics.system, q, u, 0.0 * errors)
        if self.dynamics.system.n_c:
            at = evaluated(self.dynamics, t, q, u)
            q, u = at.q, at.u
        return q, u, errors

    def distances(self, t: np.ndarray, kinks: np.ndarray, sides: np.ndarray) -> np.ndarray:
        """Return the distances from one kink each, without the errors, at times of shape (kinks, n).

        `sides` of shape (kinks,): signs of the distances of the run.
        """
        q, u, errors = self.states(t.ravel())
        found = distances_from_kinks(self.dynamics, t.ravel(), *displaced(self.dynamics.system, q, u, -errors))
        return sides[:, None] * found.reshape(*t.shape, found.shape[1])[np.arange(len(t)), :, kinks]


def missed_forces(dynamics: Dynamics, at: Evaluated, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return times at which a run misses the forces beyond a kink, s, and the changes of its errors (dq, du, ds) by these forces.

    `at`, `errors`: rows of a piece, and the errors there. The changes are of shape (times, full).
    """
    if has_kinks(dynamics.system) and len(at.t) > 2:
        with dynamics.state.unchanged():
            curves = _Curves.through(dynamics, at, (1.0 + ESTIMATE.uncertain) * errors)
            starts, ends = _beyond(curves, at)
            if len(starts):
                starts, ends = _united(starts, ends)
                return 0.5 * (starts + ends), _missed(curves, at, starts, ends)
    return np.empty(0), np.empty((0, errors.shape[1]))


def _beyond(curves: _Curves, at: Evaluated) -> tuple[np.ndarray, np.ndarray]:
    """Return the starts and ends of times in which states without the errors are beyond a kink that the run does not reach, s."""
    dynamics, t = curves.dynamics, at.t
    of_run = distances_from_kinks(dynamics, t, at.q, at.u)
    without = np.sign(of_run) * distances_from_kinks(
        dynamics, t, *displaced(dynamics.system, at.q, at.u, -curves.errors)
    )
    before, here, after = without[:-2], without[1:-1], without[2:]
    stays = (of_run[:-2] * of_run[1:-1] > 0.0) & (of_run[1:-1] * of_run[2:] > 0.0)
    may_reach = here <= np.maximum(before, after) - here  # a parabola through the rows is above zero otherwise
    rows, kinks = np.nonzero(stays & (here <= before) & (here <= after) & may_reach)
    if not len(rows):
        return np.empty(0), np.empty(0)
    sides = np.sign(of_run[1 + rows, kinks])
    lowest, least = _lowest(curves, t[rows], t[rows + 2], kinks, sides)
    found = least < 0.0
    if not found.any():
        return np.empty(0), np.empty(0)
    rows, lowest, kinks, sides = rows[found], lowest[found], kinks[found], sides[found]
    starts, ends = (_crossing(curves, lowest, t[rows + side], kinks, sides) for side in (0, 2))
    return starts, ends


def _lowest(
    curves: _Curves, low: np.ndarray, high: np.ndarray, kinks: np.ndarray, sides: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the times of the least distances within intervals, s, and these distances."""
    one = np.arange(len(low))
    for _ in range(SEARCHES):
        times = low[:, None] + (high - low)[:, None] * PLACES
        distances = curves.distances(times, kinks, sides)
        k = np.argmin(distances, axis=1)
        low, high = times[one, np.maximum(k - 1, 0)], times[one, np.minimum(k + 1, len(PLACES) - 1)]
    return times[one, k], distances[one, k]


def _crossing(
    curves: _Curves, inside: np.ndarray, outside: np.ndarray, kinks: np.ndarray, sides: np.ndarray
) -> np.ndarray:
    """Return the last times beyond a kink on the way from times beyond it to others, s, by bisection."""
    for _ in range(BISECTIONS):
        middle = 0.5 * (inside + outside)
        beyond = curves.distances(middle[:, None], kinks, sides)[:, 0] < 0.0
        inside, outside = np.where(beyond, middle, inside), np.where(beyond, outside, middle)
    return inside


def _united(starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the union of some intervals, in order."""
    order = np.argsort(starts)
    starts, ends = starts[order], np.maximum.accumulate(ends[order])
    first = np.append(True, starts[1:] > ends[:-1])
    return starts[first], ends[np.append(first[1:], True)]


def _missed(curves: _Curves, at: Evaluated, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the integrals of F(z) - F(z - e) - J e over intervals, with F(z) before the kink, shape (intervals, full)."""
    times = (starts[:, None] + (ends - starts)[:, None] * GAUSS_NODES).ravel()
    q, u, errors = curves.states(times)
    small = ESTIMATE.difference / np.maximum(np.abs(errors).max(axis=1, keepdims=True), np.finfo(float).tiny)

    def rates(moves: np.ndarray) -> np.ndarray:
        """Return F of the states after some moves (dq, du, ds)."""
        system = curves.dynamics.system
        return motion(system, evaluated(curves.dynamics, times, *displaced(system, q, u, moves)))

    here, near, there = rates(0.0 * errors), rates(-small * errors), rates(-errors)
    missed = here - there - (here - near) / small
    beyond = _are_beyond(curves, at, times, q, u)
    missed[beyond] = _of_rows(curves, at, times[beyond]) - there[beyond]
    of_intervals = missed.reshape(len(starts), len(GAUSS_NODES), -1)
    return np.asarray(np.einsum("g,ngf->nf", GAUSS_WEIGHTS, of_intervals) * (ends - starts)[:, None])


def _are_beyond(curves: _Curves, at: Evaluated, times: np.ndarray, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return a mask of states between the rows that are beyond a kink, which their rows and the steps do not show.

    Positions that drives prescribe have no error at the rows, but the run may take others between them.
    """
    before = np.clip(np.searchsorted(at.t, times, side="right") - 1, 0, len(at.t) - 2)
    signs = (
        np.sign(distances_from_kinks(curves.dynamics, *state))
        for state in ((times, q, u), *((at.t[k], at.q[k], at.u[k]) for k in (before, before + 1)))
    )
    own, left, right = signs
    return np.asarray(((left == right) & (own != left)).any(axis=1))


def _of_rows(curves: _Curves, at: Evaluated, times: np.ndarray) -> np.ndarray:
    """Return the rates at some times by cubic interpolation between rows, shape (times, full)."""
    rates = motion(curves.dynamics.system, at)
    first = np.clip(np.searchsorted(at.t, times, side="right") - 2, 0, max(len(at.t) - 4, 0))
    rows = first[:, None] + np.arange(min(4, len(at.t)))
    begin, end = at.t[rows[:, 0]], at.t[rows[:, -1]]
    curve = Curve.through(at.t[rows], rates[rows], begin, end)
    return curve.at(((times - begin) / (end - begin))[:, None], np.arange(len(times)))[1]

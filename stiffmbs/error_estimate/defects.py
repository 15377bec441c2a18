"""Defects of the recorded states: their errors as those of the collocation equations over each step.

At the points z_i of a step of length h, from z_0, these are d_i = sum_j D_ij (z_j - z_0) / h - F(z_i), the residual of a Radau method.
Those of bdf are on a smooth curve z(t) through neighbouring states: then d_i = z'(t_i) - F(z_i), without the error of the stage order in
the derivative, which stretches stiff springs. As in Newton's iteration, the error does not depend on the
points within a step to first order; a remainder of the second order stretches stiff springs, too. Where errors x of steps are large,
they are solutions of the nonlinear equations d_i = sum_j D_ij x_j / h - (F(z_i) - F(z_i - x_i)).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..dynamics.native.parameters import CONSISTENCY
from ..solve.radau.collocation import radau
from .coordinates import as_rows, displaced, typical
from .evaluated import Evaluated, evaluated, motion
from .kinks import Curve
from .parameters import ESTIMATE
from .transport import Transport


@dataclass(frozen=True, eq=False)
class Points:
    """States of a piece at the ends of its steps and at `points` places of each, and their rates.

    `t` of shape (rows,); `states`, `exact` of shape (rows, n_q + n_u): (q, u) and (q', u') of the equations. `typical` of shape
    (full,): sizes of changes (dq, du, ds) that are large.
    """

    system: System
    points: int
    t: np.ndarray
    states: np.ndarray
    exact: np.ndarray
    typical: np.ndarray

    @classmethod
    def of(cls, system: System, points: int, at: Evaluated) -> Points:
        """Return the points of evaluated states."""
        exact = np.hstack([at.q_rates, at.acceleration])
        return cls(system, points, at.t, np.hstack([at.q, at.u]), exact, typical(system, at.q, at.u))

    @property
    def ends(self) -> np.ndarray:
        """Times of the ends of the steps, s."""
        return self.t[:: self.points]

    @property
    def sizes(self) -> np.ndarray:
        """Lengths of the steps, s."""
        return np.diff(self.ends)

    @property
    def rows(self) -> np.ndarray:
        """Rows of the start and the points of each step, shape (steps, points + 1)."""
        return np.arange(len(self.sizes))[:, None] * self.points + np.arange(self.points + 1)

    def with_inner(self, t: np.ndarray, states: np.ndarray, exact: np.ndarray) -> Points:
        """Return the points with others within each step, in rows of their order."""
        inner = len(t) // len(self.sizes)
        all_states, all_exact = woven(self.states, states), woven(self.exact, exact)
        return replace(self, points=inner + 1, t=woven(self.t, t), states=all_states, exact=all_exact)

    def changes(self, change: np.ndarray) -> np.ndarray:
        """Return changes of (q, u) as rows (dq, du, ds)."""
        n_q = self.system.n_q
        return as_rows(self.system, change[:, :n_q], change[:, n_q:])

    def changes_of(self, change: np.ndarray) -> np.ndarray:
        """Return changes of (q, u) at the points of steps as rows (dq, du, ds), shape (steps, points, full)."""
        return self.changes(change.reshape(-1, change.shape[2])).reshape(*change.shape[:2], -1)

    def changes_in(self, rows: np.ndarray) -> np.ndarray:
        """Return the changes of the states since the first of `rows` of points, shape (steps, points, full)."""
        return self.changes_of(self.states[rows[:, 1:]] - self.states[rows[:, :1]])

    def defects(self, over_event: bool) -> np.ndarray:
        """Return the defects at the points of all steps, shape (steps, points, full).

        `over_event`: True if an event ends the piece, where the rates may be those after it.
        """
        rows, sizes = self.rows, self.sizes[:, None, None]
        exact = self.changes_of(self.exact[rows[:, 1:]])
        found = np.asarray(radau(self.points).derivative @ self.changes_in(rows) / sizes - exact)
        if over_event and self.points > 1:
            found[-1, -1] = found[-1, -2]
        return found


def woven(ends: np.ndarray, within: np.ndarray) -> np.ndarray:
    """Return rows of the ends of steps, with those of the points within each step between them."""
    steps = len(ends) - 1
    inner = within.reshape(steps, len(within) // steps, *within.shape[1:])
    found = np.concatenate([inner, ends[1:, None]], axis=1).reshape(-1, *ends.shape[1:])
    return np.concatenate([ends[:1], found])


def nodes_of_bdf(t: np.ndarray) -> np.ndarray:
    """Return the rows of recorded steps between which errors are transported: pairs of equal steps are one step."""
    sizes, rows = np.diff(t), np.arange(len(t) - 1)
    equals_next = np.append(np.isclose(sizes[1:], sizes[:-1], atol=0.0), False)
    first = np.append(True, ~equals_next[:-1])
    number = rows - np.maximum.accumulate(np.where(first, rows, 0))  # of a step among equal ones
    return np.append(0, 1 + rows[~equals_next | (number % 2 == 1)])


def windows(t: np.ndarray, begin: np.ndarray, end: np.ndarray, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the first row of the polynomial from row `begin` to row `end` of each step, and a mask of those without even steps.

    The step is in the middle of its polynomial if the steps there are even, otherwise as near to it as possible.
    """
    h = np.diff(t)
    middle = (points - 2) // 2
    last = len(t) - points
    first, uneven = np.clip(begin - middle, 0, last), np.ones(len(begin), dtype=bool)
    for before in sorted(range(points - 1), key=lambda before: abs(before - middle)):
        start = np.clip(begin - before, 0, last)
        sizes = h[start[:, None] + np.arange(points - 1)]
        holds = (start + points > end) & (sizes.max(axis=1) <= ESTIMATE.uneven * sizes.min(axis=1))
        first[uneven & holds], uneven[uneven & holds] = start[uneven & holds], False
    return first, uneven


def curve_of_bdf(of: Points, nodes: np.ndarray) -> tuple[Curve, np.ndarray]:
    """Return the curve between nodes, and a mask of steps where it is through the neighbouring states.

    The others, whose neighbours have far longer or shorter steps, have a curve by their two ends.
    """
    t, ends = of.t, np.column_stack([nodes[:-1], nodes[1:]])
    curve = Curve.of_ends(t[ends], of.states[ends], of.exact[ends])
    if len(t) < ESTIMATE.points:
        return curve, np.zeros(len(ends), dtype=bool)
    first, uneven = windows(t, ends[:, 0], ends[:, 1], ESTIMATE.points)
    window = first[~uneven, None] + np.arange(ESTIMATE.points)
    even = Curve.through(t[window], of.states[window], *t[ends[~uneven]].T)
    ours, theirs = curve.coefficients.shape[1], even.coefficients.shape[1]
    coefficients = np.zeros((len(ends), max(ours, theirs), of.states.shape[1]))
    coefficients[uneven, :ours], coefficients[~uneven, :theirs] = curve.coefficients[uneven], even.coefficients
    return replace(curve, coefficients=coefficients), ~uneven


def nonlinear_defects(
    dynamics: Dynamics, transport: Transport, points: Points, unknowns: np.ndarray, defects: np.ndarray, steps: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Return defects by which linear equations give the errors of some steps from their starts, and a mask of those that converge.

    `unknowns`: `Transport.rows` at the points of all steps. `defects`: defects there, shape (steps, points, full).
    """
    rows, sizes, n_q = points.rows[steps, 1:], points.sizes[steps], points.system.n_q
    exact, derivative = points.changes_of(points.exact[rows]), radau(points.points).derivative
    errors, total = np.zeros_like(exact), np.zeros_like(exact)
    last, converged, going = np.full(len(steps), np.inf), np.zeros(len(steps), dtype=bool), np.arange(len(steps))
    while len(going):
        states = points.states[rows[going]].reshape(-1, points.states.shape[1])
        q, u = displaced(points.system, states[:, :n_q], states[:, n_q:], -errors[going].reshape(len(states), -1))
        at = evaluated(dynamics, points.t[rows[going]].ravel(), np.ascontiguousarray(q), np.ascontiguousarray(u))
        there = motion(points.system, at).reshape(exact[going].shape)
        slopes = derivative @ errors[going] / sizes[going, None, None]
        residuals = defects[steps[going]] + exact[going] - there - slopes
        change = transport.apart(unknowns[steps[going]], sizes[going], residuals)
        errors[going] += change
        total[going] += residuals
        size, whole = (np.abs(each / points.typical).max(axis=(1, 2)) for each in (change, errors[going]))
        converged[going] = size <= ESTIMATE.large * whole
        nearer = size <= CONSISTENCY.restored * last[going]
        last[going] = size
        going = going[nearer & ~converged[going]]
    return total, converged

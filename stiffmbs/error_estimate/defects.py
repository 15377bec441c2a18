"""Defects of a curve through the recorded states: z' - F(t, z), integrated over the parts of each step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..compile.system import System
from ..solve.radau.collocation import radau
from ..solve.recorded_steps import Piece
from .coordinates import as_rows, typical, width
from .evaluated import Evaluated
from .kinks import Curve
from .parameters import ESTIMATE


class Rates:
    """Differences of given rates from those of the equations at evaluated states, as rows (dq, du, ds)."""

    def __init__(self, system: System, at: Evaluated) -> None:
        self._system = system
        self.states = np.hstack([at.q, at.u])
        self.exact = np.hstack([at.q_rates, at.acceleration])
        self.typical = typical(system, at.q, at.u)

    @property
    def width(self) -> int:
        """Length of a row."""
        return width(self._system)

    def defects(self, rates: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return the defects of rates (q', u') at some of the states."""
        return self.changes(rates - self.exact[rows])

    def changes(self, change: np.ndarray) -> np.ndarray:
        """Return changes of (q, u) as rows (dq, du, ds)."""
        n_q = self._system.n_q
        return as_rows(self._system, change[:, :n_q], change[:, n_q:])

    def changes_in(self, rows: np.ndarray) -> np.ndarray:
        """Return the changes of the states since the first of each `rows`, shape (steps, places, full); `rows` has one place more."""
        change = self.states[rows[:, 1:]] - self.states[rows[:, :1]]
        return self.changes(change.reshape(-1, change.shape[2])).reshape(*change.shape[:2], -1)


def slope_weights(nodes: np.ndarray, at: int | np.ndarray) -> np.ndarray:
    """Return the weights of values at nodes in the derivative of their polynomial at one of these nodes.

    `nodes` of shape (n, k); `at` of shape (n,): index of a node in each row. Berrut and Trefethen, SIAM Review 46 (2004).
    """
    count, k = nodes.shape
    span = nodes[:, -1:] - nodes[:, :1]
    x = (nodes - nodes[:, :1]) / span
    apart = x[:, :, None] - x[:, None, :] + np.eye(k)
    barycentric = 1.0 / apart.prod(axis=2)
    rows, at = np.arange(count), np.broadcast_to(at, count)
    distances = x[rows, at][:, None] - x
    distances[rows, at] = 1.0
    weights = barycentric / barycentric[rows, at][:, None] / distances
    weights[rows, at] = 0.0
    weights[rows, at] = -weights.sum(axis=1)
    return np.asarray(weights / span)


def of_bdf(piece: Piece, rates: Rates, opened: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean defects of the steps of bdf, and those at their ends, shape (rows, full); row 0, the start, is zero.

    The curve is the polynomial through the neighbouring accepted states, integrated by the trapezoid rule. Where steps
    change a lot the formula of the step gives the defect. `opened`: True if the piece starts after an event, where the
    forces of row 0 may be those before it.
    """
    t, steps = piece.t, len(piece.t) - 1
    points = ESTIMATE.points
    found = np.zeros((steps + 1, rates.width))
    at_ends = np.zeros_like(found)
    by_formula = np.ones(steps, dtype=bool)
    h = np.diff(t)
    if steps + 1 >= points:
        ends = np.arange(1, steps + 1)
        first, by_formula = _windows(h, points)
        window = first[:, None] + np.arange(points)
        sides = []
        for rows in (ends - 1, ends):
            slopes = np.einsum("nk,nkj->nj", slope_weights(t[window], rows - first), rates.states[window])
            sides.append(rates.defects(slopes, rows))
        if opened:  # the law of an event's other side may hold at its instant
            sides[0][0] = sides[1][0]
        if piece.fired:
            sides[1][-1] = sides[0][-1]
        found[1:], at_ends[1:] = 0.5 * (sides[0] + sides[1]), sides[1]
    for n in 1 + np.flatnonzero(by_formula):
        row = np.array([n])
        change = _of_formula(piece, rates.states, int(n))
        given = np.concatenate([piece.q_rates[n], piece.u_rates[n]])
        at_end = n == steps and bool(piece.fired)
        remainder = np.zeros(found.shape[1]) if at_end else rates.defects(given[None], row)[0]
        found[n] = at_ends[n] = rates.changes(change[None])[0] + remainder
    return found, at_ends


def _windows(h: np.ndarray, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the first row of the polynomial of each step, and a mask of the steps that have none with even steps.

    The step is in the middle of its polynomial if the steps there are even, otherwise as near to it as possible.
    """
    steps = len(h)
    ends = np.arange(1, steps + 1)
    middle = (points - 2) // 2
    first, uneven = np.clip(ends - 1 - middle, 0, steps + 1 - points), np.ones(steps, dtype=bool)
    for before in sorted(range(points - 1), key=lambda before: abs(before - middle)):
        start = np.clip(ends - 1 - before, 0, steps + 1 - points)
        sizes = h[start[:, None] + np.arange(points - 1)]
        even = uneven & (sizes.max(axis=1) <= ESTIMATE.uneven * sizes.min(axis=1))
        first[even], uneven[even] = start[even], False
    return first, uneven


def curve_of_bdf(piece: Piece, rates: Rates, steps: np.ndarray) -> Curve:
    """Return the curve through the neighbouring states of steps, or by their two ends where steps change a lot."""
    t, h = piece.t, np.diff(piece.t)
    ends = steps[:, None] + np.arange(2)
    curve = Curve.of_ends(t[ends], rates.states[ends], rates.exact[ends])
    if len(t) < ESTIMATE.points:
        return curve
    first, uneven = _windows(h, ESTIMATE.points)
    by_ends = uneven[steps]
    window = first[steps[~by_ends], None] + np.arange(ESTIMATE.points)
    even = Curve.through(t[window], rates.states[window], *t[ends[~by_ends]].T)
    coefficients = np.zeros((len(steps), ESTIMATE.points, rates.states.shape[1]))
    coefficients[:, :4], coefficients[~by_ends] = curve.coefficients, even.coefficients
    return replace(curve, coefficients=coefficients)


def _of_formula(piece: Piece, states: np.ndarray, n: int) -> np.ndarray:
    """Return the defect of the formula of a step from its distance to the predictor (Brenan, Campbell, Petzold 1996, ch. 5)."""
    t, order = piece.t, int(piece.order[n])
    if n == 1:
        h = t[1] - t[0]
        start = np.concatenate([piece.q_rates[0], piece.u_rates[0]])
        return np.asarray((states[1] - states[0] - h * start) / h)
    past = np.arange(n - 1, max(n - 2 - order, -1), -1)
    if len(past) < 2:
        return np.zeros(states.shape[1])
    nodes = t[past]
    apart = nodes[:, None] - nodes + np.eye(len(past))
    reach = t[n] - nodes + np.zeros((len(past), 1))
    np.fill_diagonal(reach, 1.0)
    predicted = (reach / apart).prod(axis=1) @ states[past]
    cj = (1.0 / np.arange(1, order + 1)).sum() / (t[n] - t[n - 1])
    return np.asarray((states[n] - predicted) * ((1.0 / (t[n] - nodes)).sum() - cj))


def of_radau(piece: Piece, rates: Rates) -> np.ndarray:
    """Return the defects at the points of the steps of radau, shape (steps, points, full).

    The curve is the polynomial through the states at the start of the step and at its points. At an event the rates may be those
    after it.
    """
    points = piece.points
    steps = (len(piece.t) - 1) // points
    rows = np.arange(steps)[:, None] * points + np.arange(points + 1)
    inner, h = radau(points).nodes, piece.t[rows[:, -1]] - piece.t[rows[:, 0]]
    nodes = np.broadcast_to(np.append(0.0, inner), (1, points + 1))
    slopes = np.concatenate([slope_weights(nodes, k) for k in range(1, points + 1)])
    found = np.einsum("pk,nkj->npj", slopes, rates.states[rows]) / h[:, None, None]
    of_points = rows[:, 1:].ravel()
    defects = rates.defects(found.reshape(steps * points, -1), of_points).reshape(steps, points, -1)
    if piece.fired:
        defects[-1, -1] = defects[-1, -2]
    return defects

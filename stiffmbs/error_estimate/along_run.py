"""Error of the states of one mechanism along its recorded steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.native.parameters import CONSISTENCY
from ..solve.radau.collocation import radau
from ..solve.recorded_steps import Piece
from .closed import closed
from .coordinates import displaced, displacements, width
from .defects import Points, curve_of_bdf, nodes_of_bdf, nonlinear_defects, woven
from .evaluated import Evaluated, evaluated, motion
from .grazed import missed_forces
from .kinks import Curve, Motion, dominant, integrals_of_motion, not_smooth
from .parameters import ESTIMATE
from .restarts import after_restart, autonomous, beyond_event, just_before
from .singular_poses import refuse_singular
from .transport import OF_BDF, Transport
from .vibrations import FastMotions, excited_at_start

MIDDLE = np.array([0.5])
"""Place of the recorded row within a pair of equal steps."""


@dataclass(frozen=True, eq=False)
class StateErrors:
    """Errors of the states of one mechanism.

    - `t` of shape (n,): times of the nodes, which are recorded rows, s; `recorded_q`, `recorded_u`: states of the integrator there, and `rows`: output rows
      of these after projection onto the constraints.
    - `q`, `u`: better states, without the estimated errors.
    - `errors` of shape (n, full): the errors (dq, du, ds) of the states after projection onto the constraints.
    - `left_out`: mask of nodes with other errors of forces than those nearby: at events, and near them within the error of
      their time, where errors are as large as jumps; at restarts, where stiff forces are not in balance; and where
      they could not be balanced.
    - `lost`: mask of nodes with errors too large for linear equations; if there is one, `q` and `u` are those of the integrator.
    - `restarts`: times at which the integrator started again, and of the events before, where the state is on either side, s.
    - `fast`: motions that the start excites and the steps do not follow.
    - `of_bdf`: True if the nodes are ends of steps of bdf.
    """

    t: np.ndarray
    recorded_q: np.ndarray
    recorded_u: np.ndarray
    rows: OutputRows
    q: np.ndarray
    u: np.ndarray
    errors: np.ndarray
    left_out: np.ndarray
    lost: np.ndarray
    restarts: np.ndarray
    fast: FastMotions | None = None
    of_bdf: bool = False


@dataclass(frozen=True, eq=False)
class _Prepared:
    """Piece with its evaluated states, the points of its steps at which errors are transported, and the defects there.

    - `ends` of shape (steps + 1,): rows of the start and of the ends of these steps.
    - `points` of shape (steps, points, 2 + 2 unknowns): `Transport.rows` of states; the last point of each step is its end.
    - `defects` of shape (steps, points, full): at these points.
    - `at_rows` of shape (rows, full): defects at the recorded rows, zero at the start.
    - `typical` of shape (full,): sizes of changes that are large.
    """

    piece: Piece
    states: Evaluated
    ends: np.ndarray
    points: np.ndarray
    defects: np.ndarray
    at_rows: np.ndarray
    typical: np.ndarray

    @property
    def sizes(self) -> np.ndarray:
        """Lengths of the steps, s."""
        return np.diff(self.states.t[self.ends])

    @property
    def between(self) -> np.ndarray:
        """Mask of the rows within pairs of equal steps, which are left out where stiff forces cannot be balanced."""
        found = np.full(len(self.states.t), self.piece.points == 1)
        found[self.ends] = False
        return found


def state_errors(dynamics: Dynamics, pieces: Sequence[Piece], rtol: float) -> StateErrors:
    """Return the errors of the states of a run with a tolerance; raise a SolverError if a state has no solution."""
    starts = np.append(0, np.cumsum([len(piece.t) for piece in pieces]))
    t, q, u = (np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("t", "q", "u"))
    steps = np.concatenate([np.full(len(piece.t), np.diff(piece.t[:: piece.points]).max()) for piece in pieces])
    states = evaluated(dynamics, t, q, u, (steps, rtol))
    fired = np.array([bool(piece.fired) for piece in pieces])
    alike = autonomous(dynamics, states) if fired.any() else fired
    left_out = np.zeros(len(t) + 1, dtype=bool)
    left_out[starts[1:][fired] - 1] = True
    left_out[starts[1:]] = True
    left_out, restarts = left_out[:-1], np.sort(t[np.append(starts[1:-1], starts[1:][fired] - 1)])
    if not _is_free(dynamics.system):
        nothing = np.zeros((len(t), width(dynamics.system)))
        never = np.zeros(len(t), dtype=bool)
        return StateErrors(t, q, u, states.rows, states.q, states.u, nothing, left_out, never, restarts)
    transport = Transport(dynamics, states)
    prepared: list[_Prepared] = []
    kinked = dynamics.system.n_values("event_function") > 0
    of_pieces: list[tuple[np.ndarray, np.ndarray]] = []  # errors and their rates
    error, shift = np.zeros(width(dynamics.system)), 0.0
    for k, piece in enumerate(pieces):
        opened = k > 0 and bool(pieces[k - 1].fired)
        own = slice(starts[k], starts[k + 1])
        each = _prepared(dynamics, transport, piece, states.at(own), opened, rtol)
        if k:
            error, shift = _restarted(dynamics, prepared[-1], each, error, shift, bool(alike[own].all()))
        errors, slopes = _transported(transport, each, error)
        of_shift = shift * motion(dynamics.system, each.states)
        if kinked:
            each, errors, slopes = _with_missed_forces(dynamics, transport, each, (errors, slopes), of_shift)
        error = errors[-1]
        prepared.append(each)
        of_pieces.append((errors + of_shift, slopes))
    errors = np.concatenate([each for each, _ in of_pieces])
    lost = _are_lost(dynamics.system, q, errors)
    if lost.any():
        return StateErrors(t, q, u, states.rows, q, u, errors, left_out, lost, restarts)
    slopes, at_rows = (
        np.concatenate([each for _, each in of_pieces]),
        np.concatenate([each.at_rows for each in prepared]),
    )
    of_piece = np.repeat(np.arange(len(pieces)), np.diff(starts))
    longest, large = np.array([each.sizes.max() for each in prepared]), np.array([each.typical for each in prepared])
    q_better, u_better, fails, is_open = closed(
        dynamics, transport, states, errors, slopes, at_rows, longest[of_piece], large[of_piece]
    )
    fast = excited_at_start(dynamics, states.at(slice(starts[1])), pieces[0].points)
    kept = ~(is_open & np.concatenate([each.between for each in prepared]))
    starts = np.append(0, np.cumsum(kept))[starts]
    t, q, u, errors, q_better, u_better = (each[kept] for each in (t, q, u, errors, q_better, u_better))
    left_out, lost, states = (left_out | fails)[kept], lost[kept], states.at(kept)
    for k in np.flatnonzero(fired).tolist():
        before = np.arange(starts[k], starts[k + 1] - 1)
        after = np.arange(starts[k + 1] + 1, starts[min(k + 2, len(pieces))])
        for rows in (before[::-1], after):
            left_out[beyond_event(dynamics, pieces[k].fired, rows, t, (q, u), (q_better, u_better))] = True
    of_bdf = pieces[0].points == 1
    return StateErrors(t, q, u, states.rows, q_better, u_better, errors, left_out, lost, restarts, fast, of_bdf)


def _is_free(system: System) -> bool:
    """Return True if the equations of positions leave errors a direction, or a state has a rate."""
    return int((system.active & system.holonomic).sum()) < system.n_u or len(system.with_rates) > 0


def _are_lost(system: System, q: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Return a mask of errors (dq, du, ds) that are too large for linear equations."""
    scale = system.per_velocity(system.size, 1.0)
    of_poses = displacements(system, q, errors[:, : system.n_pose])
    return np.asarray(~(np.abs(of_poses) <= ESTIMATE.lost * scale).all(axis=1))


def _prepared(
    dynamics: Dynamics, transport: Transport, piece: Piece, states: Evaluated, opened: bool, rtol: float
) -> _Prepared:
    system, step = dynamics.system, float(np.diff(states.t[:: piece.points]).max())

    def at(t: np.ndarray, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        return motion(system, evaluated(dynamics, t, q, u, (np.full(len(t), step), rtol)))

    if piece.points == 1:
        ends = nodes_of_bdf(states.t)
        curve, smooth = curve_of_bdf(Points.of(system, 1, states), ends)
        points, unknowns = _with_inner(
            dynamics, transport, curve, states.at(ends), _away_from_events(states.t[ends], piece, opened), (step, rtol)
        )
        smooth[-1] &= not piece.fired
    else:
        ends = np.arange(0, len(states.t), piece.points)
        points, unknowns, smooth = Points.of(system, piece.points, states), transport.rows(states), None
    defects = points.defects(bool(piece.fired))
    if smooth is not None and smooth.any():
        defects[smooth] += points.changes_of(curve.errors_of_slopes(OF_BDF))[smooth]
    of_points = unknowns[1:].reshape(*defects.shape[:2], -1)

    def local_errors(steps: np.ndarray, rates: np.ndarray) -> np.ndarray:
        return transport.apart(of_points[steps], points.sizes[steps], rates)

    def by_one_stage(ends: np.ndarray) -> np.ndarray:
        return transport.apart(of_points[:, -1:], points.sizes, ends[:, None] / points.sizes[:, None, None])

    def nonlinear(steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the defects of some steps by nonlinear equations, and a mask of those that are known; refuse singular poses."""
        rows = np.append(len(points.t) * np.arange(3) // 3, points.rows[steps].ravel())  # others show usual poses
        q, u = np.hsplit(points.states[rows], [dynamics.system.n_q])
        refuse_singular(dynamics, points.t[rows], q, u)  # rates are those of rounding there
        found, known = nonlinear_defects(dynamics, transport, points, of_points, defects, steps)
        at_event = bool(piece.fired) & (steps == len(defects) - 1)  # the last rates may be those after it
        return found, known & ~at_event

    means = _with_large_errors(points, defects, local_errors, by_one_stage, nonlinear, at)
    at_rows = np.zeros((len(states.t), defects.shape[2]))
    if smooth is None:
        at_rows[1:] = defects.reshape(-1, defects.shape[2])
    else:
        at_rows[ends[1:]] = defects[:, -1]
        pairs = np.flatnonzero(np.diff(ends) == 2)
        middles = ends[pairs] + 1
        exact = np.hstack([states.q_rates[middles], states.acceleration[middles]])
        at_rows[middles] = points.changes(curve.slopes(MIDDLE)[pairs, 0] - exact)
        at_rows[middles[~smooth[pairs] | np.isnan(defects[pairs, -1]).any(axis=1)]] = np.nan
    return _Prepared(piece, states, ends, of_points, means, at_rows, points.typical)


def _away_from_events(t: np.ndarray, piece: Piece, opened: bool) -> np.ndarray:
    """Return the nodes at whose states to linearise: near an event, where displacements cross it, the nearest further away."""
    near = ESTIMATE.beside * (t[-1] - t[0])
    first = int(np.searchsorted(t, t[0] + near)) if opened else 0
    last = int(np.searchsorted(t, t[-1] - near, side="right")) - 1 if piece.fired else len(t) - 1
    return np.clip(np.arange(len(t)), first, max(first, last))


def _with_inner(
    dynamics: Dynamics, transport: Transport, curve: Curve, states: Evaluated, linear_at: np.ndarray,
    balance: tuple[float, float],
) -> tuple[Points, np.ndarray]:  # fmt: skip
    """Return the points of the steps of bdf, of which those within are on a curve through recorded states, and their unknowns.

    `states`: at the ends of steps, and `linear_at` those of them to linearise at. `balance`: as in `evaluated`, of all states.

    A curve stretches a stiff spring by its own error: 1e-8 m are 100 kN at 1e13 N/m. Where its defects are a large part of the
    motion, the points within a step become those of its collocation, by Newton's iteration.
    """
    system, at_ends = dynamics.system, Points.of(dynamics.system, 1, states)
    steps, inner, ends = np.arange(len(at_ends.sizes)), OF_BDF.stages - 1, transport.rows(states)[linear_at]
    t, z = curve.at(np.tile(OF_BDF.nodes[:-1], (len(steps), 1)), steps)
    exact, unknowns = np.empty_like(z), np.empty((len(t), ends.shape[1]))
    before, rows, balanced = np.full(len(steps), np.inf), np.arange(len(t)), None
    while True:
        within = evaluated(dynamics, t[rows], z[rows, : system.n_q], z[rows, system.n_q :], balanced)
        z[rows], exact[rows] = np.hstack([within.q, within.u]), np.hstack([within.q_rates, within.acceleration])
        unknowns[rows] = transport.rows(within)
        found = at_ends.with_inner(t, z, exact)
        defects, motions = found.defects(False), found.changes(exact).reshape(len(steps), inner, -1)
        off, of_motion = (np.abs(each / found.typical).max(axis=(1, 2)) for each in (defects, motions))
        open_ = np.flatnonzero((off > ESTIMATE.large * of_motion) & (off < ESTIMATE.smooth * before))
        if not len(open_):
            return found, woven(ends, unknowns)
        rows = (open_[:, None] * inner + np.arange(inner)).ravel()
        own = np.concatenate([unknowns.reshape(len(steps), inner, -1), ends[1:, None]], axis=1)
        moves = transport.apart(own[open_], found.sizes[open_], defects[open_])
        of_inner = -moves[:, :-1].reshape(len(rows), moves.shape[2])
        z[rows] = np.hstack(displaced(system, z[rows, : system.n_q], z[rows, system.n_q :], of_inner))
        moved = displaced(system, states.q[1 + open_], states.u[1 + open_], -moves[:, -1])
        ends[1 + open_] = transport.rows(evaluated(dynamics, states.t[1 + open_], *moved))
        before, balanced = off, (np.full(len(rows), balance[0]), balance[1])


def _with_large_errors(
    points: Points,
    defects: np.ndarray,
    local_errors: Callable[[np.ndarray, np.ndarray], np.ndarray],
    by_one_stage: Callable[[np.ndarray], np.ndarray],
    nonlinear: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    at: Motion,
) -> np.ndarray:
    """Return the defects at the points of steps, with those of `nonlinear` equations where the `local_errors` are large.

    Where their iteration does not converge, as over kinks, the defects have the same integrals as those of a curve. These become
    NaN in `defects`.
    """
    method, ends, rows, sizes = radau(points.points), points.ends, points.rows, points.sizes

    def of_steps(errors: np.ndarray) -> np.ndarray:
        return np.asarray(np.abs(errors[:, -1] / points.typical).max(axis=1))

    def without(steps: np.ndarray, errors: np.ndarray) -> np.ndarray:
        """Return the mean rates to the points of some steps without some errors there."""
        return np.asarray(method.derivative @ (points.changes_in(rows[steps]) - errors) / sizes[steps, None, None])

    local = sizes[:, None, None] * (np.linalg.inv(method.derivative) @ defects)
    rates = points.changes(points.exact)[1:].reshape(defects.shape)
    missed, scale = not_smooth(rates, sizes, local)
    steps = np.flatnonzero(missed)
    if len(steps):  # stiff forces that are out of balance are not smooth, but those of the solution are
        rates[steps] = without(steps, local_errors(steps, defects[steps]))
        missed &= not_smooth(rates, sizes, local)[0]
    found, before = defects.copy(), of_steps(local)
    if dominant(before).any():  # with defects of stiff forces, which a step balances
        before = of_steps(by_one_stage(local[:, -1]))
    steps = np.flatnonzero(missed | dominant(before))
    if len(steps):
        exact, converged = nonlinear(steps)
        found[steps[converged]] = exact[converged]
        open_ = ~converged | missed[steps]
        steps, converged = steps[open_], converged[open_]
    if len(steps):
        curve = Curve.through(points.t[rows[steps]], points.states[rows[steps]], ends[steps], ends[steps + 1])
        places, most = np.append(0.0, method.nodes), ESTIMATE.intervals * len(points.t)
        integrals = integrals_of_motion(curve, places, points.system.n_q, at, scale, most)
        exact = without(steps, integrals)
        errors, plain = of_steps(local_errors(steps, exact)), of_steps(points.changes_in(rows[steps]) - integrals)
        is_stiff = (errors < CONSISTENCY.restored * plain) | (plain < CONSISTENCY.restored * errors)
        kept = np.where(converged, missed[steps] & ~is_stiff, missed[steps] | (errors < before[steps]))
        found[steps[kept]], defects[steps[kept]] = exact[kept], np.nan
    return found


def _with_missed_forces(
    dynamics: Dynamics,
    transport: Transport,
    each: _Prepared,
    found: tuple[np.ndarray, np.ndarray],
    of_shift: np.ndarray,
) -> tuple[_Prepared, np.ndarray, np.ndarray]:
    """Return a piece, its errors and their rates with forces beyond kinks that it does not reach by its errors.

    `found`: errors and rates without them. `of_shift`: further errors by a shift of time.
    """
    errors = found[0] + of_shift
    lost = np.append(_are_lost(dynamics.system, each.states.q, errors), True)
    known = slice(int(lost.argmax()))  # later errors are no distances from kinks
    times, changes = missed_forces(dynamics, each.states.at(known), errors[known])
    if not len(times):
        return each, *found
    each = _with_changes(each, times, changes)
    return each, *_transported(transport, each, found[0][0])


def _with_changes(each: _Prepared, times: np.ndarray, changes: np.ndarray) -> _Prepared:
    """Return a piece with further changes of the errors within steps at some times, shape (times, full)."""
    t, defects, at_rows = each.states.t, each.defects.copy(), each.at_rows.copy()
    steps = np.searchsorted(t[each.ends], times) - 1
    of_rows = np.searchsorted(each.ends, np.arange(1, len(t))) - 1
    rates = np.zeros((len(each.sizes), changes.shape[1]))
    np.add.at(rates, steps, changes / each.sizes[steps, None])
    defects += rates[:, None]
    at_rows[1:] += rates[of_rows]
    return replace(each, defects=defects, at_rows=at_rows)


def _transported(transport: Transport, each: _Prepared, error: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors at all rows of a piece, from that at its start, and their rates, which are NaN at the start."""
    of_points, slopes_there = transport.along(each.points, each.sizes, each.defects, error)
    errors, slopes = np.full((2, len(each.states.t), len(error)), np.nan)
    errors[0] = error
    if each.piece.points > 1:
        errors[1:], slopes[1:] = (of.reshape(-1, len(error)) for of in (of_points, slopes_there))
        return errors, slopes
    errors[each.ends[1:]], slopes[each.ends[1:]] = of_points[:, -1], slopes_there[:, -1]
    pairs = np.flatnonzero(np.diff(each.ends) == 2)
    ends = each.ends[pairs]
    polynomial = Curve.through(
        np.tile(np.append(0.0, OF_BDF.nodes), (len(pairs), 1)),
        np.concatenate([errors[ends, None], of_points[pairs]], axis=1), np.zeros(len(pairs)), np.ones(len(pairs)),
    )  # fmt: skip
    errors[ends + 1] = polynomial.at(np.tile(MIDDLE, (len(pairs), 1)), np.arange(len(pairs)))[1]
    slopes[ends + 1] = polynomial.slopes(MIDDLE)[:, 0] / each.sizes[pairs, None]
    return errors, slopes


def _restarted(
    dynamics: Dynamics, before: _Prepared, after: _Prepared, error: np.ndarray, shift: float, is_autonomous: bool
) -> tuple[np.ndarray, float]:
    """Return the error at the start of a piece and a shift of its time, s, from those at the end of the one before it.

    `is_autonomous`: True if the rates of its states do not depend on time itself.

    After an event without influences of time the motion is the same, only later or earlier: z' times that shift, which a
    numerical transport through stiff contacts would turn into errors of energy.
    """
    system = dynamics.system
    last, first = before.states.at(slice(len(before.states.t) - 1, None)), after.states.at(slice(0, 1))
    if not before.piece.fired:
        error = error + shift * motion(system, last)[0]
        return after_restart(dynamics, last, first, (), error, last)[0], 0.0
    on_left = just_before(dynamics, before.states, before.piece.fired)
    error, late = after_restart(dynamics, last, first, before.piece.fired, error, on_left)
    shift -= late
    if is_autonomous:
        return error, shift
    return error + shift * motion(system, first)[0], 0.0

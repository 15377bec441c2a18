"""Error of the states of one mechanism along its recorded steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import compress, pairwise

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics, OutputRows
from ..solve.radau.collocation import radau
from ..solve.recorded_steps import Piece
from .closed import Closed, closed
from .coordinates import displaced, displacements
from .defects import Rates, curve_of_bdf, of_bdf, of_radau, slope_weights
from .evaluated import Evaluated, evaluated
from .interpolated import Along, linearised_along
from .kinks import Curve, Motion, dominant, integrals_of_motion, not_smooth
from .linearised import Linearised
from .parameters import ESTIMATE
from .restarts import after_restart, is_autonomous, just_before, motion
from .transport import Block, blocks_of_bdf, blocks_of_radau, integrated, transported
from .vibrations import are_affordable, are_resolved, step_by_step


@dataclass(frozen=True)
class StateErrors:
    """Errors of the states of one mechanism.

    - `t` of shape (n,): times of the nodes, s; `recorded_q`, `recorded_u`: states of the integrator there, and `rows`: output rows
      of these after projection onto the constraints.
    - `q`, `u`: better states, without the estimated errors.
    - `errors` of shape (n, full): the errors (dq, du, ds) of the states after projection onto the constraints.
    - `left_out`: mask of nodes with other errors of forces than those nearby: at events, where errors of time are errors as
      large as jumps; at restarts, where stiff forces are not in balance; and where they could not be balanced.
    - `lost`: mask of nodes with errors too large for linear equations; if there is one, `q` and `u` are those of the integrator.
    - `restarts`: times at which the integrator started again, s.
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


@dataclass(frozen=True)
class _Prepared:
    """Piece with its evaluated states, the defects of its steps, their blocks and the rows of the nodes of these.

    `at_ends`: defects at the rows themselves, zero at the start. `opened`: True if it starts after an event.
    """

    piece: Piece
    states: Evaluated
    defects: np.ndarray
    at_ends: np.ndarray
    blocks: list[Block]
    rows: np.ndarray
    opened: bool

    def within(self, rows: np.ndarray) -> np.ndarray:
        """Return the rows at which to linearise: near an event, where displacements cross it, the nearest ones further away."""
        t = self.piece.t
        near = ESTIMATE.beside * (t[-1] - t[0])
        first = int(np.searchsorted(t, t[0] + near)) if self.opened else 0
        last = int(np.searchsorted(t, t[-1] - near, side="right")) - 1 if self.piece.fired else len(t) - 1
        return np.clip(rows, first, max(first, last))


@dataclass(frozen=True)
class _Found:
    """Errors at rows of a piece, the tangent spaces at the nodes of its blocks, and a mask of the blocks taken step by step."""

    piece: _Prepared
    space: Linearised
    errors: np.ndarray
    rows: np.ndarray
    step_wise: np.ndarray


def state_errors(dynamics: Dynamics, pieces: Sequence[Piece], rtol: float) -> StateErrors:
    """Return the errors of the states of a run with a tolerance; raise a SolverError if a state has no solution."""
    starts = np.append(0, np.cumsum([len(piece.t) for piece in pieces]))
    t, q, u = (np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("t", "q", "u"))
    steps = np.concatenate([np.full(len(piece.t), np.diff(piece.t[:: piece.points]).max()) for piece in pieces])
    states = evaluated(dynamics, t, q, u, (steps, rtol))
    prepared = [
        _prepared(
            dynamics, piece, states.at(slice(first, first + len(piece.t))), k > 0 and bool(pieces[k - 1].fired), rtol
        )
        for k, (piece, first) in enumerate(zip(pieces, starts, strict=False))
    ]
    nodes = np.concatenate([first + each.within(each.rows) for each, first in zip(prepared, starts, strict=False)])
    reach = max((block.times[-1] for each in prepared for block in each.blocks), default=0.0)
    counts = np.cumsum([len(each.rows) for each in prepared])
    along = linearised_along(dynamics, states.at(nodes), np.append(0, counts[:-1]), float(reach))
    found: list[_Found] = []
    error, shift, done = np.zeros(along.space.basis.shape[1]), 0.0, 0
    for k, each in enumerate(prepared):
        own, done = along.at(slice(done, done + len(each.rows))), done + len(each.rows)
        if k:
            error, shift = _restarted(dynamics, prepared[k - 1], each, error, shift)
        errors, of_errors, step_wise = _transported(dynamics, each, own, error)
        error = errors[-1]
        errors = errors + shift * motion(dynamics.system, each.states.at(of_errors))
        found.append(_Found(each, own.space, errors, of_errors, step_wise))
    errors = np.concatenate([each.errors for each in found])
    nodes = np.concatenate([first + each.rows for each, first in zip(found, starts, strict=False)])
    fired = np.array([bool(piece.fired) for piece in pieces])
    left_out = np.zeros(len(t) + 1, dtype=bool)
    left_out[starts[1:][fired] - 1] = True
    left_out[starts[1:]] = True
    lost, restarts = _are_lost(dynamics.system, q[nodes], errors), t[starts[1:-1]]
    recorded = t[nodes], q[nodes], u[nodes], states.rows.at(nodes)
    if lost.any():
        return StateErrors(*recorded, q[nodes], u[nodes], errors, left_out[nodes], lost, restarts)
    q_better, u_better, fails = (
        np.concatenate(parts) for parts in zip(*(_without_errors(dynamics, each) for each in found), strict=True)
    )
    return StateErrors(*recorded, q_better, u_better, errors, left_out[nodes] | fails, lost, restarts)


def _are_lost(system: System, q: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Return a mask of errors (dq, du, ds) that are too large for linear equations."""
    scale = system.per_velocity(system.size, 1.0)
    of_poses = displacements(system, q, errors[:, : system.n_pose])
    return np.asarray(~(np.abs(of_poses) <= ESTIMATE.lost * scale).all(axis=1))


def _prepared(dynamics: Dynamics, piece: Piece, states: Evaluated, opened: bool, rtol: float) -> _Prepared:
    rates, step = Rates(dynamics.system, states), float(np.diff(piece.t[:: piece.points]).max())

    def at(t: np.ndarray, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        return motion(dynamics.system, evaluated(dynamics, t, q, u, (np.full(len(t), step), rtol)))

    if piece.points > 1:
        defects = of_radau(piece, rates)
        blocks = blocks_of_radau(piece.t, _integrals_of_radau(piece, rates, defects, at))
        at_ends = np.vstack([np.zeros_like(defects[0, :1]), defects.reshape(-1, defects.shape[2])])
    else:
        defects, at_ends = of_bdf(piece, rates, opened)
        _resolve_kinks(piece, rates, defects, at_ends, at)
        blocks = blocks_of_bdf(piece.t, defects)
    is_node = np.zeros(len(piece.t), dtype=bool)
    for block in blocks:
        is_node[block.nodes] = True
    return _Prepared(piece, states, defects, at_ends, blocks, np.flatnonzero(is_node), opened)


def _integrals_of_radau(piece: Piece, rates: Rates, defects: np.ndarray, at: Motion) -> np.ndarray:
    """Return the integrals of the defects at the points of steps of radau, shape (steps, points, full).

    Defects in steps over kinks become NaN.
    """
    ends = piece.t[:: piece.points]
    local, exact = integrated(np.diff(ends), defects), rates.changes(rates.exact)[1:].reshape(defects.shape)
    missed, scale = not_smooth(exact, np.diff(ends), local)
    sizes = np.abs(local / rates.typical).max(axis=(1, 2))
    steps = np.flatnonzero(missed | dominant(sizes))
    if len(steps):
        rows = steps[:, None] * piece.points + np.arange(piece.points + 1)
        curve = Curve.through(piece.t[rows], rates.states[rows], ends[steps], ends[steps + 1])
        places, most = np.append(0.0, radau(piece.points).nodes), ESTIMATE.intervals * len(piece.t)
        found = rates.changes_in(rows) - integrals_of_motion(curve, places, piece.q.shape[1], at, scale, most)[0]
        kept = missed[steps] | (np.abs(found / rates.typical).max(axis=(1, 2)) < sizes[steps])
        local[steps[kept]], defects[steps[kept]] = found[kept], np.nan
    return local


def _resolve_kinks(piece: Piece, rates: Rates, defects: np.ndarray, at_ends: np.ndarray, at: Motion) -> None:
    """Integrate the defects of the steps of bdf that are far above the others; those at the ends of these steps become NaN.

    Defects that it increases are left: a curve through a few states is not in balance with stiff forces.
    """
    h, most = np.diff(piece.t)[:, None], ESTIMATE.intervals * len(piece.t)
    sizes, done = np.abs(h * defects[1:] / rates.typical).max(axis=1), np.zeros(len(h), dtype=bool)
    while len(steps := np.flatnonzero(dominant(sizes) & ~done)) and len(steps) <= most:
        done[steps] = True
        scale = rates.typical * sizes[~done].max(initial=np.finfo(float).tiny)
        curve, places = curve_of_bdf(piece, rates, steps), np.array([0.0, 1.0])
        exact, most = integrals_of_motion(curve, places, piece.q.shape[1], at, scale, most)
        found = (rates.changes_in(steps[:, None] + np.arange(2)) - exact)[:, 0]
        now = np.abs(found / rates.typical).max(axis=1)
        kept = now < sizes[steps]
        steps = steps[kept]
        sizes[steps], defects[steps + 1], at_ends[steps + 1] = now[kept], found[kept] / h[steps], np.nan


def _transported(
    dynamics: Dynamics, each: _Prepared, along: Along, error: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the errors at rows of a piece, from that at its start, these rows, and a mask of the blocks taken step by step."""
    t, rows, blocks, space = each.piece.t, each.rows, each.blocks, along.space
    place = np.full(len(t), -1)
    place[rows] = np.arange(len(rows))
    step_wise = np.zeros(len(blocks), dtype=bool)
    if each.piece.points == 1 and are_affordable(len(t), len(error)):
        step_wise = ~are_resolved(space, t, rows, blocks)
    errors, of_errors = [error[None]], [rows[:1]]
    for first, last in pairwise([0, *1 + np.flatnonzero(np.diff(step_wise)), len(blocks)]):
        begin, end = int(blocks[first].nodes[0]), int(blocks[last - 1].nodes[-1])
        own = slice(place[begin], place[end] + 1)
        if step_wise[first]:
            found, at = _step_by_step(dynamics, each, along.at(own), slice(begin, end + 1), errors[-1][-1])
        else:
            found, at = transported(blocks[first:last], space, place, errors[-1][-1])[own], rows[own]
        errors.append(found[1:])
        of_errors.append(at[1:])
        if not first:
            errors[0], of_errors[0] = found[:1], at[:1]
    return np.concatenate(errors), np.concatenate(of_errors), step_wise


def _step_by_step(
    dynamics: Dynamics, each: _Prepared, along: Along, steps: slice, error: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors at all rows of some steps of a piece, from that at their start, and these rows."""
    rows, t = np.arange(steps.start, steps.stop), each.piece.t[steps]
    nodes = each.rows[(each.rows >= steps.start) & (each.rows < steps.stop)]
    if (along.computed[1:] & along.computed[:-1]).any():  # matrices between nodes are not near a line
        at = each.states.at(each.within(rows))
        nodes, along = rows, linearised_along(dynamics, at, np.zeros(1, dtype=int), float(np.diff(t).max()))
    knots = along.computed.copy()
    knots[[0, -1]] = True
    return step_by_step(t, each.defects[steps], along.space.at(knots), nodes[knots] - steps.start, error), rows


def _without_errors(dynamics: Dynamics, found: _Found) -> Closed:
    """Return q and u at rows of a piece without their errors, closed at the ends of blocks, and a mask of failures."""
    each, errors, rows = found.piece, found.errors, found.rows
    at = each.states.at(rows)
    q, u = displaced(dynamics.system, at.q, at.u, -errors)
    open_ = np.zeros(len(rows), dtype=bool)
    places = np.searchsorted(rows, each.rows)
    slopes = np.full((len(each.rows), errors.shape[1]), np.nan)
    own = list(compress(each.blocks, ~found.step_wise))
    for size in {len(block.nodes) for block in own}:
        some = [block for block in own if len(block.nodes) == size]
        nodes, times = np.array([block.nodes for block in some]), np.array([block.times for block in some])
        times = np.hstack([np.zeros((len(some), 1)), times])
        of_nodes, ends = errors[np.searchsorted(rows, nodes)], np.searchsorted(each.rows, nodes)
        for k in range(1, size):
            slopes[ends[:, k]] = np.einsum("bn,bnf->bf", slope_weights(times, k), of_nodes)
    slopes -= each.at_ends[each.rows]
    step = float(np.diff(each.piece.t).max())
    q[places], u[places], open_[places] = closed(dynamics, at.at(places), found.space, errors[places], slopes, step)
    return q, u, open_


def _restarted(
    dynamics: Dynamics, before: _Prepared, after: _Prepared, error: np.ndarray, shift: float
) -> tuple[np.ndarray, float]:
    """Return the error at the start of a piece and a shift of its time, s, from those at the end of the one before it.

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
    if is_autonomous(dynamics, after.states.at(after.rows)):
        return error, shift
    return error + shift * motion(system, first)[0], 0.0

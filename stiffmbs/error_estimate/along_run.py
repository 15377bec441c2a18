"""Error of the states of one mechanism along its recorded steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..solve.recorded_steps import Piece
from .defects import Rates, of_bdf, of_radau
from .evaluated import Evaluated, evaluated
from .linearised import Linearised, linearised
from .parameters import ESTIMATE
from .restarts import after_restart, displaced, is_autonomous, just_before, motion
from .transport import Block, blocks_of_bdf, blocks_of_radau, transported
from .vibrations import are_affordable, are_resolved, changes_little, step_by_step


@dataclass(frozen=True)
class StateErrors:
    """Errors of the states of one mechanism.

    - `t` of shape (n,): times of the nodes, s; `recorded_q`, `recorded_u`: states of the integrator there.
    - `q`, `u`: better states, without the estimated errors.
    - `errors` of shape (n, full): the errors (x, v, s) of the states after projection onto the constraints.
    - `at_event`: mask of the nodes at events, where errors of time are errors as large as jumps.
    """

    t: np.ndarray
    recorded_q: np.ndarray
    recorded_u: np.ndarray
    q: np.ndarray
    u: np.ndarray
    errors: np.ndarray
    at_event: np.ndarray


@dataclass(frozen=True)
class _Prepared:
    """Piece with its evaluated states, the defects of its steps, their blocks and the rows of the nodes of these.

    `opened`: True if it starts after an event.
    """

    piece: Piece
    states: Evaluated
    defects: np.ndarray
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


def state_errors(dynamics: Dynamics, pieces: Sequence[Piece]) -> StateErrors:
    """Return the errors of the states of a run; raise a SolverError if a state has no solution."""
    starts = np.append(0, np.cumsum([len(piece.t) for piece in pieces]))
    t, q, u = (np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("t", "q", "u"))
    states = evaluated(dynamics, t, q, u)
    prepared = [
        _prepared(dynamics, piece, states.at(slice(first, first + len(piece.t))), k > 0 and bool(pieces[k - 1].fired))
        for k, (piece, first) in enumerate(zip(pieces, starts, strict=False))
    ]
    nodes = np.concatenate([first + each.within(each.rows) for each, first in zip(prepared, starts, strict=False)])
    space = linearised(dynamics, states.at(nodes))
    found, rows, done = [np.zeros((0, space.basis.shape[1]))], [], 0
    error, shift = np.zeros(space.basis.shape[1]), 0.0
    for k, each in enumerate(prepared):
        own, done = slice(done, done + len(each.rows)), done + len(each.rows)
        if k:
            error, shift = _restarted(dynamics, prepared[k - 1], each, error, shift)
        errors, of_errors = _transported(dynamics, each, space.at(own), error)
        error = errors[-1]
        found.append(errors + shift * motion(dynamics.system, each.states.at(of_errors)))
        rows.append(starts[k] + of_errors)
    errors, nodes = np.concatenate(found), np.concatenate(rows)
    fired = np.array([bool(piece.fired) for piece in pieces])
    at_event = np.zeros(len(t) + 1, dtype=bool)
    at_event[np.concatenate([starts[1:][fired] - 1, starts[1:][fired]])] = True
    better = displaced(dynamics, states.at(nodes), -errors)
    return StateErrors(t[nodes], q[nodes], u[nodes], *better, errors, at_event[nodes])


def _prepared(dynamics: Dynamics, piece: Piece, states: Evaluated, opened: bool) -> _Prepared:
    rates = Rates(dynamics.system, states)
    if piece.points > 1:
        defects = of_radau(piece, rates)
        blocks = blocks_of_radau(piece.t, defects)
    else:
        defects = of_bdf(piece, rates, opened)
        blocks = blocks_of_bdf(piece.t, defects)
    is_node = np.zeros(len(piece.t), dtype=bool)
    for block in blocks:
        is_node[block.nodes] = True
    return _Prepared(piece, states, defects, blocks, np.flatnonzero(is_node), opened)


def _transported(
    dynamics: Dynamics, each: _Prepared, space: Linearised, error: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors at rows of a piece, from that at its start, and these rows."""
    t, rows = each.piece.t, each.rows
    steps = np.diff(t, prepend=2 * t[0] - t[1])[rows]
    by_steps = each.piece.points == 1 and are_affordable(len(t), len(error))
    if by_steps and not are_resolved(space, t[rows], steps):
        everywhere = np.arange(len(t))
        if not changes_little(space, t[rows]):
            rows, space = everywhere, linearised(dynamics, each.states.at(each.within(everywhere)))
        return step_by_step(t, each.defects, space, rows, error), everywhere
    place = np.full(len(t), -1)
    place[rows] = np.arange(len(rows))
    return transported(each.blocks, space, place, error), rows


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

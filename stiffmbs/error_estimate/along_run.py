"""Error of the states of one mechanism along its recorded steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..solve.recorded_steps import Piece
from .defects import Rates, of_bdf, of_radau, slope_weights
from .evaluated import Evaluated, evaluated
from .linearised import linearised
from .parameters import ESTIMATE
from .restarts import after_restart, displaced
from .transport import blocks_of_bdf, blocks_of_radau, transported


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


def state_errors(dynamics: Dynamics, pieces: Sequence[Piece]) -> StateErrors:
    """Return the errors of the states of a run; raise a SolverError if a state has no solution."""
    starts = np.append(0, np.cumsum([len(piece.t) for piece in pieces]))
    t, q, u = (np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("t", "q", "u"))
    states = evaluated(dynamics, t, q, u)
    prepared = []
    for k, (piece, first) in enumerate(zip(pieces, starts, strict=False)):
        own = states.at(slice(first, first + len(piece.t)))
        rates = Rates(dynamics.system, own)
        if piece.points > 1:
            blocks = blocks_of_radau(piece.t, of_radau(piece, rates))
        else:
            opened = k > 0 and bool(pieces[k - 1].fired)
            blocks = blocks_of_bdf(piece.t, of_bdf(piece, rates, opened))
        prepared.append((own, blocks, np.unique(np.concatenate([block.nodes for block in blocks]))))
    nodes = np.concatenate([first + own for (_, _, own), first in zip(prepared, starts, strict=False)])
    space = linearised(dynamics, states.at(_within_the_law(nodes, pieces, starts)))
    errors = np.zeros((len(nodes), space.basis.shape[1]))
    error, done = np.zeros(space.basis.shape[1]), 0
    for k, (piece, (own, blocks, rows)) in enumerate(zip(pieces, prepared, strict=True)):
        place = np.full(len(piece.t), -1)
        place[rows] = done + np.arange(len(rows))
        if k:
            before = prepared[k - 1][0]
            last = len(before.t) - 1
            error = after_restart(
                dynamics, before.at(slice(last, None)), own.at(slice(0, 1)), pieces[k - 1].fired, error, _last_rates(before)
            )  # fmt: skip
        found = transported(blocks, space, place, error)
        chosen = slice(done, done + len(rows))
        errors[chosen] = found[chosen]
        error, done = errors[done + len(rows) - 1], done + len(rows)
    at = states.at(nodes)
    fired = np.array([bool(piece.fired) for piece in pieces])
    events = np.concatenate([starts[1:][fired] - 1, starts[1:][fired]])
    return StateErrors(t[nodes], q[nodes], u[nodes], *displaced(dynamics, at, -errors), errors, np.isin(nodes, events))


def _within_the_law(nodes: np.ndarray, pieces: Sequence[Piece], starts: np.ndarray) -> np.ndarray:
    """Return the states at which to linearise: before an event, that at the start of the last step."""
    found = nodes.copy()
    for piece, first in zip(pieces, starts, strict=False):
        if piece.fired:
            found[found == first + len(piece.t) - 1] -= 1
    return found


def _last_rates(piece: Evaluated) -> np.ndarray:
    """Return (q', u') at the end of a piece, from its last states."""
    last = slice(max(len(piece.t) - ESTIMATE.points, 0), None)
    states = np.hstack([piece.q[last], piece.u[last]])
    return np.asarray(slope_weights(piece.t[None, last], len(states) - 1)[0] @ states)

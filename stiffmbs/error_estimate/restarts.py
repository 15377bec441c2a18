"""The error of a state across a restart: at a breakpoint in time, and at an event whose time has an error of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..errors import SolverError
from ..solve.events.discontinuity import event_functions
from ..solve.events.restart import restarted
from .coordinates import as_rows, displaced
from .evaluated import Evaluated, evaluated, motion
from .parameters import ESTIMATE


def after_restart(
    dynamics: Dynamics,
    before: Evaluated,
    after: Evaluated,
    fired: tuple[int, ...],
    error: np.ndarray,
    on_left: Evaluated,
) -> tuple[np.ndarray, float]:
    """Return the error (dq, du, ds) after a restart from that before it, as a part at the event and a delay of the motion, s.

    `before`, `after`: the state on both sides, one each. `fired`: event functions. `on_left`: a state just before, with the
    rates there. An event of g is late by dt = (g - g_q e_q - g_u e_u) / g', as g is not exactly zero, and e+ = jump(e- + f- dt) - f+ dt.
    """
    system = dynamics.system
    rates = np.concatenate([on_left.q_rates[0], on_left.acceleration[0]])
    late = _late(dynamics, before, fired, error, rates) if fired else 0.0
    moved = error + late * motion(system, replace(on_left, q=before.q, u=before.u))[0]
    jumped = np.abs(after.u - before.u).max(initial=0.0) > ESTIMATE.difference * np.abs(before.u).max(initial=0.0)
    if jumped:
        moved = _jumped(dynamics, before, float(after.t[0]), moved)
    return moved, late


def autonomous(dynamics: Dynamics, at: Evaluated) -> np.ndarray:
    """Return a mask of the states whose rates do not depend on time itself."""
    shift = ESTIMATE.difference * np.maximum(1.0, np.abs(at.t))
    later = evaluated(dynamics, at.t + shift, at.q, at.u)
    now = evaluated(dynamics, at.t, at.q, at.u)
    both = (np.hstack([each.q, each.u, each.q_rates, each.acceleration]) for each in (now, later))
    return np.asarray(np.equal(*both).all(axis=1))


def just_before(dynamics: Dynamics, piece: Evaluated, fired: tuple[int, ...]) -> Evaluated:
    """Return a state just before the event that ends a piece, where its forces are those of the piece."""
    end, previous = len(piece.t) - 1, len(piece.t) - 2
    sides = _event_values(dynamics, fired, float(piece.t[previous]), piece.q[previous], piece.u[previous]) > 0.0
    step = piece.t[end] - piece.t[previous]
    back = ESTIMATE.difference * step
    while back < step:
        t, q = piece.t[end] - back, piece.q[end] - back * piece.q_rates[previous]
        u = piece.u[end] - back * piece.acceleration[previous]
        if np.array_equal(_event_values(dynamics, fired, float(t), q, u) > 0.0, sides):
            return evaluated(dynamics, np.array([t]), q[None], u[None])
        back *= 10.0
    return piece.at(slice(previous, end))


def beyond_event(
    dynamics: Dynamics, fired: tuple[int, ...], rows: np.ndarray, t: np.ndarray, *states: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Return those of some rows next to an event whose states without their errors lie on its other side.

    `rows`: in the order of their distance from the event. `states`: q and u of the run, and those without errors.
    """
    for k, row in enumerate(rows):
        recorded, better = (_event_values(dynamics, fired, float(t[row]), q[row], u[row]) > 0.0 for q, u in states)
        if np.array_equal(recorded, better):
            return rows[:k]
    return rows


def _event_values(dynamics: Dynamics, fired: tuple[int, ...], t: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the values of some event functions at a state."""
    return event_functions(dynamics, np.array([t]), q[None], u[None])[0, list(fired)]


def _late(dynamics: Dynamics, at: Evaluated, fired: tuple[int, ...], error: np.ndarray, rates: np.ndarray) -> float:
    """Return the delay of an event by the error of the state."""
    t, n_q = float(at.t[0]), dynamics.system.n_q
    step = ESTIMATE.difference * max(1.0, abs(t))
    size = ESTIMATE.difference / max(float(np.abs(error).max()), np.finfo(float).tiny)

    def value(later: float, part: float) -> float:
        q, u = displaced(dynamics.system, at.q, at.u, part * error[None])
        moved = q[0] + later * rates[:n_q], u[0] + later * rates[n_q:]
        return float(_event_values(dynamics, fired, t + later, *moved)[0])

    before, now, after = (value(later, 0.0) for later in (-step, 0.0, step))
    jumps = abs(before - 2.0 * now + after) > ESTIMATE.smooth * abs(after - before)
    if jumps:  # by an event of another function
        late = _crossing(lambda later: value(later, size), step) - _crossing(lambda later: value(later, -size), step)
        return late / (2.0 * size) if np.isfinite(late) else 0.0
    slope, by_error = (after - before) / (2.0 * step), (value(0.0, size) - value(0.0, -size)) / (2.0 * size)
    with np.errstate(divide="ignore", invalid="ignore"):
        late = float((now - np.float64(by_error)) / slope)
    return late if np.isfinite(late) else 0.0


def _crossing(value: Callable[[float], float], step: float) -> float:
    """Return the time nearest to 0 at which a function changes its sign, NaN if there is none.

    `step`: of differences, s. The search begins with far shorter times: the sign may have changed for an instant only.
    """
    from scipy.optimize import bisect

    reach = step * ESTIMATE.difference
    while (value(-reach) > 0.0) == (is_after := value(reach) > 0.0):
        reach *= 2.0
        if reach > step / ESTIMATE.difference:
            return np.nan

    def side(later: float) -> float:
        if abs(later) == reach:  # known, and within rounding of zero it may differ when it is evaluated again
            return float(np.sign(later))
        return 1.0 if (value(later) > 0.0) == is_after else -1.0

    return float(bisect(side, -reach, reach, xtol=step * ESTIMATE.difference))


def _jumped(dynamics: Dynamics, at: Evaluated, t: float, error: np.ndarray) -> np.ndarray:
    """Return the error after the velocities have jumped at time t, by a difference of restarts."""
    size = ESTIMATE.difference / max(float(np.abs(error).max()), np.finfo(float).tiny)
    moved = displaced(dynamics.system, at.q, at.u, size * error[None])
    try:
        base, there = restarted(dynamics, t, at.q[0], at.u[0]), restarted(dynamics, t, moved[0][0], moved[1][0])
    except SolverError:
        return error
    return as_rows(dynamics.system, (there.q - base.q)[None], (there.u - base.u)[None])[0] / size

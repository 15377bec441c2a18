"""Forces on both sides of an event function that is about zero: whether they jump, and whether they drive the motion back to it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from ..dynamics import Dynamics

LARGER_MOVE, SMALLER_MOVE = 1e-6, 1e-9
"""Sizes of moves, relative to the state and at least of 1 m, rad, m/s, rad/s, that take the state to both sides."""
JUMPS, LEAST_JUMP = 0.1, 1e-9
"""A force jumps where the smaller move leaves that part of the larger one's change of accelerations, and that many
m/s^2 or rad/s^2."""
BISECTIONS = 30
"""Halvings of a move in search of the zero of an event function: from 0.1 to the rounding of the smaller move."""
RATE_INTERVAL = 1e-4
"""Time, s, over which the rate of an event function is taken."""


@dataclass(frozen=True)
class _Side:
    """A state near the one looked at: values of the event functions, accelerations, and rates that these give the event functions."""

    values: np.ndarray
    acceleration: np.ndarray
    rates: np.ndarray


def jumping(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The event functions about zero across which accelerations jump.

    Parameters
    ----------
    t : float
        s.
    q, u : ndarrays, shapes (n_q,), (n_u,)

    Returns
    -------
    ndarray of int
    """
    with dynamics.state.unchanged():
        crossed = _crossed(dynamics, t, q, u)
        if not len(crossed):
            return crossed
        far, near = (
            float(np.max(np.abs(a.acceleration - b.acceleration), initial=0.0))
            for a, b in (_sides(dynamics, t, q, u, size) for size in (LARGER_MOVE, SMALLER_MOVE))
        )
    return crossed if near > max(JUMPS * far, LEAST_JUMP) else crossed[:0]


def sliding(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, reach: float = LARGER_MOVE) -> np.ndarray:
    """The event functions that the motion is driven to from both sides, by a force that jumps there.

    There is then no solution in the ordinary sense but a sliding mode (Filippov, Differential Equations with
    Discontinuous Righthand Sides, 1988, ch. 2): sign(v) at rest is one.

    Parameters
    ----------
    reach : float
        Size of the move, as `LARGER_MOVE`, within which a jump is looked for.
    """
    with dynamics.state.unchanged():
        back = _crossed(dynamics, t, q, u, reach)
        for way in _ahead_first(dynamics, t, q, u, reach, back) if len(back) else ():
            back = back[_returns(_side(dynamics, t, *_moved(q, u, way * reach)), back)]
            if not len(back):
                return back
        return np.array([k for k in back if _slides(dynamics, t, q, u, reach, k)], dtype=int)


def _ahead_first(
    dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, reach: float, crossed: np.ndarray
) -> tuple[float, float]:
    """Both ways of a move, first to the side that the state is on: a motion that goes through the zero leaves it there."""
    here, there = (_values(dynamics, t, *_moved(q, u, way * reach))[crossed[0]] for way in (0.0, 1.0))
    return (1.0, -1.0) if here * there > 0.0 else (-1.0, 1.0)


def _returns(side: _Side, event_functions: np.ndarray) -> np.ndarray:
    """Whether the motion returns from a side to the zero of each event function."""
    returns: np.ndarray = side.rates[event_functions] * side.values[event_functions] < 0.0
    return returns


def _driven_back(sides: list[_Side], event_functions: np.ndarray) -> np.ndarray:
    """Whether the motion returns from both sides to the zero of each event function."""
    return np.logical_and(*(_returns(side, event_functions) for side in sides))


def _slides(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, reach: float, event_function: int) -> bool:
    """Whether the rates on both sides of an event function's zero differ as much however near the sides are to it."""
    q, u = _moved(q, u, _zero_within(dynamics, t, q, u, reach, event_function))
    change = []
    for size in (LARGER_MOVE, SMALLER_MOVE):
        sides = _sides(dynamics, t, q, u, size)
        if not _driven_back(sides, np.array([event_function]))[0]:
            return False
        change.append(abs(sides[0].rates[event_function] - sides[1].rates[event_function]))
    far, near = change
    return bool(near > max(JUMPS * far, LEAST_JUMP))


def _zero_within(
    dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, reach: float, event_function: int
) -> float:
    """The size of the move, between -reach and reach, at which an event function changes its sign."""
    low, high = -reach, reach
    above = _values(dynamics, t, *_moved(q, u, high))[event_function] > 0.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if (_values(dynamics, t, *_moved(q, u, middle))[event_function] > 0.0) == above:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


def _crossed(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, reach: float = SMALLER_MOVE) -> np.ndarray:
    """The event functions that differ in sign between the two sides of a move."""
    one, other = (_values(dynamics, t, *_moved(q, u, way * reach)) for way in (1.0, -1.0))
    return np.flatnonzero(one * other < 0.0)


def _sides(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, size: float) -> list[_Side]:
    return [_side(dynamics, t, *_moved(q, u, way * size)) for way in (1.0, -1.0)]


def _moved(q: np.ndarray, u: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    parts = _direction(len(q), len(u))
    moved = [x + size * np.maximum(1.0, np.abs(x)) * part for x, part in zip((q, u), parts, strict=True)]
    return moved[0], moved[1]


@cache
def _direction(n_q: int, n_u: int) -> tuple[np.ndarray, np.ndarray]:
    """A direction of moves that every coordinate and velocity takes part in."""
    rng = np.random.default_rng(1)
    first, second = (rng.choice((-1.0, 1.0), n) * rng.uniform(0.5, 1.0, n) for n in (n_q, n_u))
    return first, second


def _side(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> _Side:
    values = _values(dynamics, t, q, u)
    status, acceleration = dynamics.accelerate(t)
    if status < 0:
        acceleration = np.full(len(u), np.nan)  # compares as no jump
    moved = dynamics.system.of_body.moved(q, RATE_INTERVAL * u)
    ahead = _values(dynamics, t + RATE_INTERVAL, moved, u + RATE_INTERVAL * acceleration)
    return _Side(values, acceleration, (ahead - values) / RATE_INTERVAL)


def _values(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The event functions at a state, which the dynamics' own becomes."""
    state = dynamics.state
    state.q[:], state.u[:] = q, u
    state.evaluate("event_function", t)
    return state.values["event_function"][: dynamics.system.n_event_functions].copy()

"""Forces on both sides of a switch that is about zero: whether they jump, and whether they drive the motion back to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .mechanics import Mechanics

FAR, NEAR = 1e-6, 1e-9
"""Sizes of moves, in parts of the state and at least of 1 m, rad, m/s, rad/s, that take the state to both sides."""
JUMPS, LEAST = 0.1, 1e-9
"""A force jumps where the smaller move leaves that part of the larger one's change of accelerations, and that many
m/s^2 or rad/s^2."""
AHEAD = 1e-4
"""Time, s, over which the rate of a switch is taken."""


@dataclass(frozen=True)
class _Side:
    """A state near the one looked at: values of the switches, accelerations, and rates that these give the switches."""

    values: np.ndarray
    acceleration: np.ndarray
    rates: np.ndarray


def jumping(mechanics: Mechanics, t: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The switches about zero across which accelerations jump.

    Parameters
    ----------
    t : float
        s.
    q, u : ndarrays, shapes (n_q,), (n_u,)

    Returns
    -------
    ndarray of int
    """
    crossed = _crossed(mechanics, t, q, u)
    if not len(crossed):
        return crossed
    far, near = (
        float(np.max(np.abs(a.acceleration - b.acceleration), initial=0.0))
        for a, b in (_sides(mechanics, t, q, u, size) for size in (FAR, NEAR))
    )
    return crossed if near > max(JUMPS * far, LEAST) else crossed[:0]


def sliding(mechanics: Mechanics, t: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The switches that the motion is driven to from both sides, by a force that jumps there.

    There is then no solution in the ordinary sense but a sliding mode (Filippov, Differential Equations with
    Discontinuous Righthand Sides, 1988, ch. 2): sign(v) at rest is one.
    """
    crossed = _crossed(mechanics, t, q, u)
    if not len(crossed):
        return crossed
    back, change = np.ones(len(crossed), dtype=bool), []
    for size in (FAR, NEAR):
        a, b = (_of(side, crossed) for side in _sides(mechanics, t, q, u, size))
        back &= (a.rates * a.values < 0.0) & (b.rates * b.values < 0.0)
        change.append(np.abs(a.rates - b.rates))
    far, near = change
    return crossed[back & (near > JUMPS * far) & (near > LEAST)]


def _of(side: _Side, switches: np.ndarray) -> _Side:
    return _Side(side.values[switches], side.acceleration, side.rates[switches])


def _crossed(mechanics: Mechanics, t: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The switches that differ in sign between the two sides of the smaller move."""
    one, other = (_values(mechanics, t, *_moved(q, u, way * NEAR)) for way in (1.0, -1.0))
    return np.flatnonzero(one * other < 0.0)


def _sides(mechanics: Mechanics, t: float, q: np.ndarray, u: np.ndarray, size: float) -> list[_Side]:
    return [_side(mechanics, t, *_moved(q, u, way * size)) for way in (1.0, -1.0)]


def _moved(q: np.ndarray, u: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(1)
    moved = [x + size * np.maximum(1.0, np.abs(x)) * rng.uniform(-1, 1, len(x)) for x in (q, u)]
    return moved[0], moved[1]


def _side(mechanics: Mechanics, t: float, q: np.ndarray, u: np.ndarray) -> _Side:
    values = _values(mechanics, t, q, u)
    status, acceleration = mechanics.accelerate(t)
    if status < 0:
        acceleration = np.full(len(u), np.nan)  # compares as no jump
    moved = mechanics.system.of_body.moved(q, AHEAD * u)
    ahead = _values(mechanics, t + AHEAD, moved, u + AHEAD * acceleration)
    return _Side(values, acceleration, (ahead - values) / AHEAD)


def _values(mechanics: Mechanics, t: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The switches at a state, which the mechanics' own becomes."""
    state = mechanics.state
    state.q[:], state.u[:] = q, u
    state.evaluate("switch", t)
    return state.values["switch"][: mechanics.system.n_switches].copy()

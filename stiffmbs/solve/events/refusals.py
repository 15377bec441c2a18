"""Where a run is stopped: its motion has left what mechanics describes, or a force the limits within which its law holds."""

from __future__ import annotations

import numpy as np

from ...compile.system import System
from ...compile.written_values import beyond
from ...errors import SolverError
from ..dynamics import Dynamics
from ..suspect import suspect
from ..trajectory import Rows

SPEED_OF_LIGHT = 299_792_458.0
"""Speed of light, m/s."""
UNBOUNDED_MOTION = 1e4
"""Sizes of the mechanism, or rad, that a motion may come to where it grows faster than under any force over time."""
DECADES, FASTER = (1e-4, 1e-2, 1.0), 2.5
"""Parts of the largest motion; the time from the second to the third may be so many times that from the first to the
second: 10 under a constant force, 3.2 where a force grows as time squared, 1 for exponential growth."""
FOLLOWED_STEPS = 100_000
"""Steps for which a motion is followed wherever it goes."""
INSTANTS = 2000
"""Of those stored, at which growth is looked at."""


def refuse_beyond_sense(dynamics: Dynamics, rows: Rows, t: float, q: np.ndarray, u: np.ndarray) -> None:
    """Stop a run that has diverged; to be asked after `FOLLOWED_STEPS` alone.

    Parameters
    ----------
    dynamics : Dynamics
    rows : Rows
        What the run has stored so far.
    t : float
        Where it is, s.
    q, u : ndarrays, shapes (n_q,), (n_u,)
        There.

    Raises
    ------
    SolverError
        Where a body is faster than light, or the motion grows like an exponential beyond `UNBOUNDED_MOTION`; names the body and the
        element that pulls hardest.
    """
    system = dynamics.system
    speed, body = fastest(system, u)
    if speed > SPEED_OF_LIGHT:
        raise SolverError(
            _sentence(dynamics, t, q, u, f"body '{body}' comes to {speed:.3g} m/s, beyond the speed of light")
        )
    times, places, _ = rows.stored
    few = slice(None, None, 1 + len(times) // INSTANTS)
    far = np.max(np.abs(np.vstack([places[few], q]) - places[0]) * reaches(system), axis=1, initial=0.0)
    if far[-1] > UNBOUNDED_MOTION * system.size and exponential(np.append(times[few], t), np.maximum.accumulate(far)):
        what = f"body '{body}' has moved by {far[-1]:.3g} m, and ever faster, in a mechanism of {system.size:.3g} m"
        raise SolverError(_sentence(dynamics, t, q, u, what))


def _sentence(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, what: str) -> str:
    likely = suspect(dynamics, t, q.copy(), u.copy())
    remedy = "look for a wrong sign of a stiffness, damping or force"
    return f"stopped at t = {t:.9g} s: the motion grows beyond sense: {what}{likely}; {remedy}"


def reaches(system: System) -> np.ndarray:
    """What turns coordinates into lengths, m: 1 for places, the mechanism's size for angles, 0 for quaternions and states."""
    lengths = system.per_coordinate(1.0, system.size)
    lengths[system.quaternions] = 0.0
    lengths[system.first_state :] = 0.0
    return lengths


def fastest(system: System, u: np.ndarray) -> tuple[float, str]:
    """The largest speed, of centres of mass and of turning times the mechanism's size, m/s, and whose it is."""
    if not system.bodies:
        return 0.0, ""
    speeds = np.abs(u) * system.per_velocity(1.0, system.size)
    k = int(np.argmax(speeds))
    return float(speeds[k]), system.bodies[k // system.of_body.n_u]


def exponential(t: np.ndarray, reached: np.ndarray) -> bool:
    """Whether what was reached grew faster than any power of time that forces make, for certain.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Instants, s.
    reached : ndarray, shape (n,)
        The largest up to each of them.
    """
    first, second, last = (int(np.argmax(reached >= part * reached[-1])) for part in DECADES)
    if not first < second - 1 < last:
        return False
    return bool(t[last] - t[second - 1] < FASTER * (t[second - 1] - t[first]))


def refuse_beyond_limits(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> None:
    """Stop a run whose state has passed the limits of a force, as the turns beyond which a spring cannot tell its angle.

    Raises
    ------
    SolverError
        Names the element.
    """
    system, state = dynamics.system, dynamics.state
    first, end = system.first_limit, system.n_event_functions
    if first == end:
        return
    state.q[:], state.u[:] = q, u
    state.evaluate("event_function", t)
    passed = np.flatnonzero(state.values["event_function"][first:end] <= 0)
    if len(passed):
        raise SolverError(f"stopped at t = {t:.9g} s: {beyond(system, first + int(passed[0]))}")

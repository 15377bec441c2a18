"""Refusal of diverged motions and of forces beyond the limits of their laws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ...compile.system import System
from ...compile.written_values import beyond
from ...dynamics.dynamics import Dynamics
from ...errors import SolverError
from ...model.settings import DEFAULT_POINTS
from ...notes import Note
from ...tuning import tuned
from ..reasons import Reason
from ..suspect import suspect
from ..trajectory import Rows


@dataclass(frozen=True)
class DivergenceParameters:
    """Parameters that decide when a motion has diverged."""

    unbounded: float = 1e4
    """Largest displacement of a motion that grows exponentially, in sizes of the mechanism or rad."""
    fraction: float = 1e-2
    """Fraction of the largest displacement, and of that fraction, between which times are compared."""
    faster: float = 2.5
    """Largest ratio of these times that indicates exponential growth. It is 10 for a constant force, 3.2 for a force
    that grows as time squared, and 1 for an exponential."""
    followed_steps: int = 100_000
    """Steps before a motion is checked."""


DIVERGENCE = tuned("divergence", DivergenceParameters())

SPEED_OF_LIGHT: Final = 299_792_458.0
"""Speed of light, m/s."""


def refuse_beyond_sense(dynamics: Dynamics, rows: Rows, t: float, q: np.ndarray, u: np.ndarray) -> None:
    """Stop a run that has diverged; to be called only after `DivergenceParameters.followed_steps`.

    `rows`: stored states of the run. `t`: current time, s. `q`, `u` of shapes (n_q,), (n_u,): current state. Raises
    SolverError if a body is faster than light, or the motion grows exponentially beyond all bounds; names the body and
    the element with the largest force.
    """
    system = dynamics.system
    speed, body = fastest(system, u)
    if speed > SPEED_OF_LIGHT:
        raise SolverError(
            _sentence(dynamics, t, q, u, f"body '{body}' reaches {speed:.3g} m/s, more than the speed of light")
        )
    times, places, _ = rows.stored
    few = slice(None, None, 1 + len(times) // DEFAULT_POINTS)
    far = np.max(np.abs(np.vstack([places[few], q]) - places[0]) * reaches(system), axis=1, initial=0.0)
    if far[-1] > DIVERGENCE.unbounded * system.size and exponential(
        np.append(times[few], t), np.maximum.accumulate(far)
    ):
        what = (
            f"body '{body}' has moved by {far[-1]:.3g} m, growing exponentially, in a mechanism of {system.size:.3g} m"
        )
        raise SolverError(_sentence(dynamics, t, q, u, what))


def _sentence(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, what: str) -> Note:
    likely = suspect(dynamics, t, q.copy(), u.copy())
    return Reason.DIVERGED.of(
        f"stopped at t = {t:.9g} s: the motion diverges: {what}{likely}; {Reason.DIVERGED.remedy}"
    )


def reaches(system: System) -> np.ndarray:
    """Return factors from coordinates to lengths, m: 1 for positions, the mechanism's size for angles, 0 for others."""
    lengths = system.per_coordinate(1.0, system.size)
    lengths[system.quaternions] = 0.0
    lengths[system.first_state :] = 0.0
    return lengths


def fastest(system: System, u: np.ndarray) -> tuple[float, str]:
    """Return the largest speed, m/s, with angular velocities times the mechanism's size, and its body."""
    if not system.bodies:
        return 0.0, ""
    speeds = np.abs(u) * system.per_velocity(1.0, system.size)
    k = int(np.argmax(speeds))
    return float(speeds[k]), system.bodies[k // system.of_body.n_u]


def exponential(t: np.ndarray, reached: np.ndarray) -> bool:
    """Return True if a displacement grew faster than any power of time that forces produce.

    `t` of shape (n,): times, s. `reached` of shape (n,): largest displacement up to each time.
    """
    parts = (DIVERGENCE.fraction**power for power in (2, 1, 0))
    first, second, last = (int(np.argmax(reached >= part * reached[-1])) for part in parts)
    if not first < second - 1 < last:
        return False
    return bool(t[last] - t[second - 1] < DIVERGENCE.faster * (t[second - 1] - t[first]))


def refuse_beyond_limits(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> None:
    """Stop a run whose state has passed the limits of a force, such as the resolvable revolutions of a torsion spring.

    Raises SolverError if a limit is passed; names the element.
    """
    system, state = dynamics.system, dynamics.state
    first, end = system.first_limit, system.n_event_functions
    if first == end:
        return
    state.q[:], state.u[:] = q, u
    state.evaluate("event_function", t)
    passed = np.flatnonzero(state.values["event_function"][first:end] <= 0)
    if len(passed):
        found = beyond(system, first + int(passed[0]))
        raise SolverError(Reason.OUT_OF_RANGE.of(f"stopped at t = {t:.9g} s: {found}"))

"""Detection of tolerances finer than the rounding of a coordinate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...compile.system import System
from ...dynamics.dynamics import Dynamics
from ...model.settings import RunSettings
from ...tuning import tuned
from ..explicit.native.parameters import CONTROL


@dataclass(frozen=True)
class PrecisionParameters:
    """Parameters that decide when a tolerance is finer than the rounding of a coordinate.

    Source: ``tests/solve/test_precision.py``.
    """

    noise_of_angles: float = 1e-3
    """Rounding of an angle, relative to the absolute tolerance, above which differences of order 5 are rounding
    only."""
    noise_of_positions: float = 0.05
    """The same for a position, whose tolerance grows with it."""
    failed: float = 0.2
    """Fraction of steps with a failed error test above which rounding governs a long run."""


PRECISION = tuned("precision", PrecisionParameters())


def too_fine(dynamics: Dynamics, settings: RunSettings, t: float, q: np.ndarray) -> str:
    """Return a sentence that explains why the tolerance cannot be met at a state; empty if it can.

    `t`: s. `q` of shape (n_q,): coordinates, m and rad.
    """
    return _known_too_little(dynamics.system, settings, q) or _held_too_little(dynamics, settings, t, q)


def _held_too_little(dynamics: Dynamics, settings: RunSettings, t: float, q: np.ndarray) -> str:
    """Return a sentence on a constraint whose rounding moves coordinates beyond the tolerance; empty if none does."""
    system, state = dynamics.system, dynamics.state
    if not system.n_c:
        return ""
    state.q[:] = q
    state.evaluate("motion", t)
    jacobian = system.term("motion", "C_q")
    entries = state.values["motion"][jacobian.source]
    slopes = np.sqrt(np.bincount(jacobian.row, entries**2, minlength=system.n_c))
    slopes[~(system.active & system.holonomic) | np.isnan(slopes)] = np.inf
    row = int(np.argmin(slopes))
    rounding = np.finfo(float).eps * max(1.0, float(np.abs(q[: system.n_pose]).max()))
    name, tolerance = _tolerance(settings)
    moved = rounding / slopes[row] if slopes[row] > 0.0 else np.inf
    if not moved > tolerance:
        return ""
    return (
        f"{name} = {tolerance:g} is below rounding: the derivatives of '{system.equations[row][0]}' by coordinates are at most "
        f"{slopes[row]:.1g}, so its rounding moves coordinates by {moved:.1g}; expected "
        "an equation with larger derivatives, or solver projected with scheme dop853"
    )


def _tolerance(settings: RunSettings) -> tuple[str, float]:
    """Return the name and value of the setting that governs coordinates near zero."""
    return ("rtol", settings.rtol) if settings.atol is None else ("atol", settings.atol)


def _known_too_little(system: System, settings: RunSettings, q: np.ndarray) -> str:
    """Return a sentence on a coordinate whose rounding exceeds the tolerance; empty if there is none.

    Joints transmit the rounding of positions and angles to all coordinates of their bodies, so it is compared with the
    tolerance of a coordinate near zero.  BDF estimates errors by differences of order k + 1, which
    multiply rounding by up to 2^(k+1).
    """
    of_body = system.of_body
    own = q[: of_body.n_q * len(system.bodies)].reshape(-1, of_body.n_q)
    straight, turning = own[:, : of_body.linear], own[:, of_body.linear : of_body.n_u]
    if of_body.dimensions == 3:
        turning = turning[:, :0]  # quaternions have unit length
    name, tolerance = _tolerance(settings)
    of_positions = np.spacing(np.abs(straight)) / 2 / (PRECISION.noise_of_positions * tolerance * min(1.0, system.size))
    of_angles = np.spacing(np.abs(turning)) / 2 / (PRECISION.noise_of_angles * tolerance)
    excess = np.hstack([of_positions, of_angles])
    body, k = np.unravel_index(int(np.argmax(excess)), excess.shape)
    if not system.n_c or not excess[body, k] > 1.0:
        return ""
    value, unit = float(own[body, k]), "m" if k < of_body.linear else "rad"
    return (
        f"{name} = {tolerance:g} is below rounding: {system.bodies[body]}.{of_body.positions[k]} = "
        f"{value:.4g} {unit} has a rounding error of {np.spacing(abs(value)) / 2:.1g} {unit}; expected "
        f"{name} = {tolerance * max(10.0, excess[body, k]):.1g} or more, or solver projected with scheme dop853"
    )


def governed_by_rounding(statistics: Mapping[str, Any]) -> bool:
    """Return True if a long run fails the error test so often that rounding governs it."""
    steps, rejected = int(statistics["steps"]), int(statistics.get("rejected", 0))
    return steps > CONTROL.enough_steps and rejected > PRECISION.failed * steps

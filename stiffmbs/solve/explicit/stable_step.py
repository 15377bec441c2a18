"""Stability bound on explicit steps, computed before the error estimate detects instability.

Near rest, steps grow tenfold each. A step far beyond the stability limit amplifies rounding to errors just below the
tolerance, which persist and which the estimate detects too late. Steps limited by the estimate oscillate about the
stability limit. The fastest rate of the motion gives the limit at the cost of one step. It is computed when two stages
at a step's end indicate that the limit is far exceeded, or that it has limited several steps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from ...compile.machine.layout import addresses
from ...compile.machine.routines import Routine
from ...dynamics.algebraic_states import rates_by_states
from ...dynamics.dynamics import ACCELERATE, Dynamics
from ...tuning import tuned
from .integration import Integration
from .scheme import Scheme


@dataclass(frozen=True)
class StabilityBoundParameters:
    """Parameters that decide when the stability bound of explicit steps is computed.

    Source: ``tests/solve/explicit/test_stable_step.py``.
    """

    soon: int = 8
    """Steps between the first two checks of a bound, and factor on the next intervals."""
    most_apart: int = 512
    """Largest interval."""
    worth: int = 128
    """Smallest number of remaining steps that justifies the cost of the rate."""
    held_back: int = 16
    """Steps limited by stability since the last computation, at which the bound is computed."""
    steep: int = 8
    """Lowest order at which too long a step amplifies rounding considerably."""


STABILITY_BOUND = tuned("stability_bound", StabilityBoundParameters())

FASTEST_RATES = Routine(
    "stiffmbs.solve.explicit.native.fastest_rate",
    "fastest_rates",
    "void(float64, float64*, float64*, float64*, int64*, int64)",
)
NOT_ASKED: Final = 0.0
"""Bound that has not been computed."""
UNBOUNDED: Final = float("inf")
"""No bound."""


class StableStep:
    """Stability bound on the steps of a run up to its first event."""

    def __init__(self, scheme: Scheme, dynamics: Dynamics) -> None:
        self._stability, self._dynamics = scheme.stability, dynamics
        self._serves = scheme.order >= STABILITY_BOUND.steep
        self._next, self._apart, self._held_before = 0, STABILITY_BOUND.soon, 0

    def begin(self, work: Integration, events: int) -> bool:
        """Restart; return True if the bound is used, up to the first event, as later restarts are too many."""
        serves = self._serves and events == 0
        self._forget(work)
        if not serves:
            work.stable = UNBOUNDED
        return serves

    def _forget(self, work: Integration) -> None:
        work.stable, self._held_before = NOT_ASKED, work.count("stiff_steps")

    def wait(self, work: Integration) -> int:
        """Return the largest number of steps up to the next check."""
        return work.capacity if work.stable == NOT_ASKED else max(1, self._next - work.count("steps"))

    def held(self, work: Integration) -> int:
        """Return the largest number of steps limited by stability up to the next check."""
        return self._left(work) if work.stable == NOT_ASKED else work.capacity

    def _left(self, work: Integration) -> int:
        return STABILITY_BOUND.held_back - (work.count("stiff_steps") - self._held_before)

    def look(self, work: Integration, end: float) -> None:
        """Update the bound if due: after limited steps, or if steps have grown to the last bound."""
        if work.stable == NOT_ASKED:
            if self._left(work) <= 0:
                self.ask(work, end)
        elif work.count("steps") < self._next:
            return
        elif work.stable == UNBOUNDED:
            self._forget(work)
        elif work.stable < work.h:
            self.ask(work, end)
        else:
            self._wait(work)

    def ask(self, work: Integration, end: float) -> None:
        """Compute the bound at the current state, unless few steps remain.

        Near a pose where branches of the motion meet, the rate is that of the pose only: no bound is used there.
        """
        bound, work.stable = work.stable or UNBOUNDED, UNBOUNDED
        self._next = work.count("steps") + STABILITY_BOUND.worth
        if end - work.t < STABILITY_BOUND.worth * min(work.h, bound) or work.count("uncertain"):
            return
        rate = rates_at(self._dynamics, work.t, work.q.copy(), work.u.copy()).fastest
        if rate > 0:
            work.stable = self._stability / rate
            self._wait(work)

    def _wait(self, work: Integration) -> None:
        """Set the next check, at an interval that grows each time."""
        self._next = work.count("steps") + self._apart
        self._apart = min(STABILITY_BOUND.soon * self._apart, STABILITY_BOUND.most_apart)


class Rates(NamedTuple):
    """Rates of the motion about a state, 1/s; the fastest are bounds from below, which are close for separate rates.

    Attributes
    ----------
    vibration : float
        Circular frequency of the fastest vibration without damping.
    damping : float
        Largest damping of any motion: its rate of decay without stiffness.
    excited, decay : float
        Circular frequency and damping of the vibration that accelerations excite, by Rayleigh quotients.
    states : float
        Rate of the user-defined states at a fixed motion.
    velocity : ndarray of shape (n_u,)
        Amplitude of the velocities in that vibration, m/s and rad/s.
    """

    vibration: float
    damping: float
    excited: float
    decay: float
    states: float
    velocity: np.ndarray

    @property
    def fastest(self) -> float:
        """Return the largest |lambda|."""
        return max(self.vibration, self.damping, self.states)

    @property
    def damping_ratio(self) -> float:
        """Return the largest damping over that which makes the fastest vibration aperiodic; infinite without a vibration."""
        return self.damping / (2.0 * self.vibration) if self.vibration > 0.0 else math.inf

    @property
    def decay_ratio(self) -> float:
        """Return the decay of the excited motion in a radian of it: its damping ratio, 1/2 of damping alone."""
        return 0.5 * min(self.decay / self.excited, 1.0) if self.excited > 0.0 else 0.5


def rates_at(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> Rates:
    """Return the fastest rates of the motion about a state on the constraints.

    They cost about as much as a step of order 8.
    """
    state = dynamics.state
    state.q[:], state.u[:] = q, u
    n_u = dynamics.system.n_u
    found, work = np.zeros(4), np.zeros(3 * n_u + dynamics.system.n_q)
    arrays = dynamics.system.mass, found, work, dynamics.table
    FASTEST_RATES.call(t, *addresses(*arrays), ACCELERATE.address)
    dynamics.forget_pivots(within_run=True)
    # its accelerations are this change over the square of the frequency
    velocity = np.abs(work[n_u : 2 * n_u]) / found[2] ** 3 if found[2] > 0.0 else np.zeros(n_u)
    vibration, damping, excited, decay = found.tolist()
    return Rates(vibration, damping, excited, decay, _of_states(dynamics, t, q, u), velocity)


def _of_states(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> float:
    """Return the largest |lambda| of the user-defined states at a fixed motion, 1/s."""
    system, state = dynamics.system, dynamics.state
    if not system.states:
        return 0.0
    state.q[:], state.u[:] = q, u
    state.evaluate("tangent", t)
    own = rates_by_states(dynamics)
    return float(np.abs(np.linalg.eigvals(own)).max(initial=0.0)) if np.all(np.isfinite(own)) else 0.0

"""Events that repeat: event functions that hover about zero, and runs that chatter."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...compile.written_values import writer
from ...dynamics.dynamics import Dynamics
from ...dynamics.friction_loads import REMEDY, ambiguous_loads_clause
from ...errors import ChatteringError, SolverError
from ...tuning import tuned
from .discontinuity import JUMP, noise_of, sliding
from .native.parameters import SEARCH

if TYPE_CHECKING:
    from ..stiff_rows import States


@dataclass(frozen=True)
class ChatteringParameters:
    """Parameters that decide when a run would not end.

    Source: ``tests/events/test_chattering.py`` and the stress tests of bouncing balls and sticking friction.
    """

    window: int = 250
    """Events over which their rate is measured."""
    too_many: float = 1e6
    """Expected further events, steps governed by rounding, or evaluations at which a run is stopped, and steps that
    periodic laws may require."""
    at_least: float = 1e4
    """Their least number at which growth is considered."""
    least_power: float = 0.8
    largest_power: float = 2.0
    """Bounds of the power of the number of events with which their rate grows in an exponentially driven motion.
    Bounces of a ball with damping have larger powers, and their number is finite."""
    steps_seen: int = 500_000
    """Steps over which the rate of a run is measured."""
    steps_ahead: float = 2e8
    """Expected further steps at which it is stopped."""
    stays_within: float = 1e3
    """Distance from a jump up to which a state is assumed to stay there, relative to rtol."""
    stays_within_at_most: float = 0.1
    """Upper bound of that distance, and of the change of a velocity in a fixed step, m/s and rad/s."""


CHATTERING = tuned("chattering", ChatteringParameters())


class Chattering:
    """Monitor of one run of an integrator. `end`: end of the run, s. `rtol`: relative tolerance of the integrator."""

    def __init__(self, dynamics: Dynamics, end: float, rtol: float) -> None:
        self._dynamics, self._end = dynamics, end
        farthest = min(max(JUMP.larger_move, CHATTERING.stays_within * rtol), CHATTERING.stays_within_at_most)
        self._reaches = (JUMP.larger_move, farthest)  # far from a jump, stiff forces may hide it
        self._events: deque[float] = deque(maxlen=2 * CHATTERING.window + 1)
        self._count = 0
        self._mark: tuple[float, int] | None = None

    def begin(self, t: float, q: np.ndarray, u: np.ndarray, reach: float | None = None) -> None:
        """Check the state from which the integrator starts, or another one.

        Raises ChatteringError if a force drives the motion back from both sides of its discontinuity within `reach` (see
        `sliding`); names the element.
        """
        if sentence := _of_sliding(self._dynamics, t, q, u, reach):
            raise ChatteringError(f"stopped at t = {t:.9g} s: {sentence}")

    def look(self, t: float, q: np.ndarray, u: np.ndarray, steps: int) -> None:
        """Check a state after `steps` steps of the run.

        Raises ChatteringError if a force drives the motion back from both sides of its discontinuity. Raises
        SolverError if the steps are too short to reach the end.
        """
        for reach in self._reaches:
            self.begin(t, q, u, reach)
        since, before = self._mark or (t, steps)
        if steps - before < CHATTERING.steps_seen:
            self._mark = since, before
            return
        self._mark = t, steps
        mean_step = (t - since) / (steps - before)
        if self._end - t > CHATTERING.steps_ahead * mean_step:
            raise SolverError(
                f"stopped at t = {t:.9g} s: the last {steps - before} steps covered only {t - since:.3g} s, and the rest of the run would take "
                f"at least {CHATTERING.steps_ahead:.0e} more; look for a singularity: a force that divides by "
                "a velocity at rest, a jump without a breakpoint, or a mechanism that locks; or the tolerance is below the rounding of the coordinates"
            )

    def note_event(self, t: float, state: Callable[[], States], event_function: int) -> None:
        """Record an event; `state` returns q and u there. The number of the event function is negative if it is unknown.

        Raises ChatteringError when events accumulate so that the run would not end; names the element.
        """
        self._count += 1
        self._events.append(t)
        if self._count % CHATTERING.window or len(self._events) <= 2 * CHATTERING.window:
            return
        first, middle, last = (self._events[k] for k in (0, CHATTERING.window, 2 * CHATTERING.window))
        if self._to_come(middle - first, last - middle) > CHATTERING.too_many:
            self.begin(t, *state())
            if loads := _of_loads(self._dynamics, t, *state()):
                raise ChatteringError(f"stopped at t = {t:.9g} s: {loads}")
            name = (
                f"'{writer(self._dynamics.system, 'event_function', event_function)}'"
                if event_function >= 0
                else "a force"
            )
            raise ChatteringError(
                f"stopped at t = {t:.9g} s: {name} chatters: it has passed breakpoints {self._count} times, now once in "
                f"{(last - middle) / CHATTERING.window:.3g} s, so the run would not end; expected a force without a jump where the motion comes "
                "to rest, a relay with hysteresis, or a force that does not drive the motion beyond all bounds"
            )

    def _to_come(self, before: float, last: float) -> float:
        """Return the expected number of events up to the end, from the durations of the last two windows.

        With a rate f ~ N of events N, their number grows as exp(f t/N).
        """
        steady = (self._end - self._events[-1]) / max(last, 1e-300) * CHATTERING.window
        if steady < CHATTERING.at_least or last <= 0.0:
            return steady
        power = math.log(before / last) / math.log(
            (self._count - 0.5 * CHATTERING.window) / (self._count - 1.5 * CHATTERING.window)
        )
        growing = CHATTERING.least_power < power < CHATTERING.largest_power
        return self._count * math.exp(min(steady / self._count, 100.0)) if growing else steady


def _of_sliding(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, reach: float | None = None) -> str:
    """Return a sentence on a force that drives the motion back from both sides of its jump; empty if there is none."""
    if not dynamics.system.n_event_functions or not len(found := sliding(dynamics, t, q, u, reach)):
        return ""
    return _of_loads(dynamics, t, q, u) or jump_sentence(dynamics, int(found[0]))


def _of_loads(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> str:
    """Return a sentence on friction with several solutions, between which a motion may change without end."""
    clause = ambiguous_loads_clause(dynamics, t, q, u)
    return f"{clause}, between which the motion changes without end; {REMEDY}" if clause else ""


def jump_sentence(dynamics: Dynamics, event_function: int) -> str:
    """Return a sentence on a chattering force."""
    name = writer(dynamics.system, "event_function", event_function)
    if name in dynamics.system.forces_by_reactions:
        return (
            f"'{name}' chatters: its load or speed changes sign, and the accelerations on both sides drive the motion back to "
            f"that sign change, so that no solution exists beyond; {REMEDY}"
        )
    return (
        f"'{name}' chatters: the force jumps, for example because its sign changes where "
        "the motion comes to rest, and the accelerations on both sides drive the motion back to the jump, so that no solution "
        "of this law exists beyond; expected a steep, continuous force there: joint_friction with its stiction_velocity, or tanh(v/0.001) in place of sign(v)"
    )


class HoveringEvents:
    """Event functions of one run that stay about zero, up to the precision of their evaluation.

    An event function that has returned to zero from within the precision of its evaluation has had no event but
    errors. A restart that takes a function back across zero shows that its precision is that move at best. Its next event is where it leaves that band. `chattering`: monitor of the same run. `rtol`: relative tolerance. `band` of shape
    (n_event_functions,): half width of the band, 0 for a function with an event at zero.
    """

    def __init__(self, dynamics: Dynamics, chattering: Chattering, rtol: float) -> None:
        self._dynamics, self._chattering, self._rtol = dynamics, chattering, rtol
        self.band = np.zeros(dynamics.system.n_event_functions)
        self._left: dict[int, float] = {}
        self._beyond: dict[int, float] = {}
        self._moved: dict[int, float] = {}

    @property
    def any(self) -> bool:
        """Return True if the system has event functions."""
        return bool(len(self.band))

    def note(self, t: float, q: np.ndarray, u: np.ndarray, fired: Sequence[int], farthest: np.ndarray) -> None:
        """Record the events that ended a segment, and the largest values of the event functions within it.

        Raises ChatteringError if a force drives the motion back from both sides of its discontinuity; names the element.
        """
        self._left = {k: self.band[k] for k in fired if self.band[k]}
        self.band[list(self._left)] = 0.0
        at_zero = {k: farthest[k] for k in fired if k not in self._left}
        found = noise_of(self._dynamics, t, q, u, self._rtol, at_zero) if at_zero else {}
        self._beyond = {k: value for k, (value, _) in found.items()}
        bands = {k: max(noise, self._moved.get(k, 0.0)) for k, (_, noise) in found.items()}
        if hovering := {k: band for k, band in bands.items() if at_zero[k] <= band}:
            self._chattering.begin(t, q, u)
            self.band[list(hovering)] = list(hovering.values())

    def taken_back(self, t: float) -> bool:
        """Return True if a restart, to the current state, has taken functions back into the bands that they had left.

        The step had larger errors than its tolerance, as velocities have that no error test includes: the bands are doubled.
        """
        self._moved = {}
        if not (self._left or self._beyond):
            return False
        self._dynamics.state.evaluate("event_function", t)
        values = self._dynamics.state.values["event_function"]
        self._moved = {k: 2.0 * abs(values[k]) for k, beyond in self._beyond.items() if values[k] * beyond < 0.0}
        back = {k: 2.0 * left for k, left in self._left.items() if abs(values[k]) < (1.0 - SEARCH.margin) * left}
        self.band[list(back)] = list(back.values())
        return bool(back)

    def failed(self, t: float, q: np.ndarray, u: np.ndarray) -> str:
        """Return a sentence on a force that drives the motion back from both sides of its jump; empty if there is none."""
        return _of_sliding(self._dynamics, t, q, u)

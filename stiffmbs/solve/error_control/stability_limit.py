"""Whether BDF of order 3 to 5 creeps along a vibration too small to matter.

These formulas are not stable near the imaginary axis (Hairer, Wanner, Solving Ordinary Differential Equations II, ch.
V.1): longer steps let a stiff, little damped vibration grow to the tolerance, the error test shortens them again, and so
they never come out of its periods.  Order 2 damps it.  CVODE looks for such growth at constant steps (STALD); IDA has
nothing of the kind, and what shows here is simpler: many steps in a row follow a cubic but for some tolerances.

Order 2 has larger errors in the slow motion.  So the order is held only where its steps become much longer: the third derivative of
that cubic tells how long a step of order 2 may be.  A vibration of a few tolerances is damped within a hundred steps; the
order is free again then, before the errors of order 2 count.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from ...compile.equations import Equations
from ...compile.machine.layout import addresses
from ...compile.machine.routines import Routine
from ...describe.settings import RunSettings
from .tolerances import independent_tolerances

CUBIC = Routine(
    "stiffmbs.solve.error_control.native.cubic",
    "cubic",
    "void(int64, int64, float64*, float64, float64*, int64, int64*, float64, float64*, float64*)",
)
STATES_LOOKED_AT, STEPS_APART = 16, 4
"""States that are looked at, and steps from one to the next: motion that steps of order 3 to 5 do resolve is some thousands of
tolerances away from a cubic."""
FAR_APART = np.array([0, 4, 8, 12, 15], dtype=np.int64)
"""States that mostly show by themselves that all are far from it."""
NEGLIGIBLE = 150.0
"""Distance from it, in units of the tolerance, up to which a vibration is not worth following: the orders that follow it
damp it too (from 64 to 44 in 1000 steps of order 5).  A smaller tolerance keeps it."""
STUCK, STEADY = 0.5, 3.0
"""Steps whose states are nearer to it are short for another reason, and so are those much shorter than since the last look."""
FAINT, DAMPED_AWAY = 4.0, 100
"""Distance from it up to which so many steps of order 2 damp the vibration away.  The half car at 1e-7 takes 3445 steps with
100 of them and errors of 3.4e-7, 3569 and 8.2e-7 with 300, 5079 and 1.2e-7 with none."""
WITHIN_PERIODS = 12.0
"""Longest step, times a bound on the fastest vibration's rate, that is still within the reach of its instability; a fresh
start with longer ones would stir up vibrations that have long been damped."""
FIRST_LOOK, LATER = 2000, 1.5
"""Steps before the first look, and how many times as many before each later one."""
RELAPSE, STRETCH, LONGER = 2000, 2000, 4
"""Steps between looks at a held order, in which the vibration dies away (250 are too few to see what is gained); steps with
the order held at first, and how many times as many after each relapse."""
GAIN = 3.0
"""How much longer steps must become with the order held: predicted from the slow motion before it is, and seen after that.  The errors of order 2
are larger at the same tolerance.  On a car on bushings of 1e7 N/m 1.4 to 1.9 is predicted; steps were then as long as before, and errors ten
times as large.  On a bar on one bushing, where the order is held, steps become 3 to 40 times as long."""
NO_LOSS = 1.5
"""The same, predicted, where a faint vibration is damped away: longer steps come after that."""
MARGIN, ERROR_CONSTANT = 0.1, 2 / 9
"""Error of a step that an integrator aims at, relative to the tolerance; that of order 2, over the third derivative times the cube of the step."""
TIGHTEST_HELD = 1e-7
"""Relative tolerance below which the order is not held for long: who asks for less wants to see the vibration, and order 2 would
cost more digits than it saves steps (measured: at 1e-9 a position off by 6.5e-5 m where free orders are right to 4e-7)."""
HELD, HIGHEST = 2, 5
"""Orders: the highest that is stable for every vibration, and the highest of all."""


def cubic_fit(samples: np.ndarray, rtol: float, atol: np.ndarray) -> tuple[float, float, float]:
    """How far states are from the cubics that fit best, in units of the tolerance.

    Parameters
    ----------
    samples : ndarray, shape (`STATES_LOOKED_AT`, 1 + n)
        Times and states.
    rtol : float
    atol : ndarray, shape (n,)

    Returns
    -------
    least : float
        The distance that five of them show.
    distance : float
        The largest of one state, as a root mean square; not computed where `least` is beyond `NEGLIGIBLE`, as what follows.
    highest : float
        Root mean square of the coefficients of the third power, times being -1 to 1.
    """
    count, n = len(samples), samples.shape[1] - 1
    samples, work, found = np.ascontiguousarray(samples), np.empty(n + 6 * count + 8), np.zeros(3)
    rows, at_atol, few, at_work, at_found = addresses(samples, atol, FAR_APART, work, found)
    CUBIC.short_call(count, n, rows, rtol, at_atol, len(FAR_APART), few, NEGLIGIBLE, at_work, at_found)
    least, distance, highest = found.tolist()
    return least, distance, highest


class StabilityLimitDetection:
    """When to hold the order down, and when to leave it free again.

    Parameters
    ----------
    equations : Equations
    settings : RunSettings

    Attributes
    ----------
    order : int
        The highest order to be used.
    """

    def __init__(self, equations: Equations, settings: RunSettings) -> None:
        self._rtol, self._highest = settings.rtol, settings.max_order or HIGHEST
        self._watches, self._holds = settings.max_order is None, settings.rtol >= TIGHTEST_HELD
        self._equations, self._settings = equations, settings
        self.forget()

    @cached_property
    def _atol(self) -> np.ndarray:
        return independent_tolerances(self._equations, self._settings)

    def forget(self) -> None:
        """Begin a new run."""
        self.order, self._next, self._stretch = self._highest, FIRST_LOOK, STRETCH
        self._held: list[tuple[float, int]] = []
        self._held_steps = 0
        self._briefly = False
        self._mark, self._pace, self._fastest = (0.0, 0), 0.0, 0.0

    @property
    def held(self) -> bool:
        """Whether the order is held down."""
        return self.order < self._highest

    def begin(self, t: float, steps: int, fastest: float) -> None:
        """The integrator starts, or starts anew, where vibrations have rates up to `fastest`, 1/s."""
        self._mark, self._fastest = (t, steps), fastest

    def due(self, steps: int) -> bool:
        """Whether it is time for a look, after so many steps of the run."""
        return steps >= self._next and self._watches

    def wait(self, steps: int) -> int:
        """How many steps from now on the next look is due."""
        return self._next - steps if self._watches and self._next > steps else FIRST_LOOK

    def changed(self, samples: np.ndarray, steps: int) -> bool:
        """Look at the last steps; whether the highest order is to change.

        Parameters
        ----------
        samples : ndarray, shape (n, 1 + 2 * independent)
            Time, independent coordinates and velocities after some of the last steps.
        steps : int
            Of the whole run.
        """
        if len(samples) < STATES_LOOKED_AT:
            return False
        t, (since, before) = float(samples[-1, 0]), self._mark
        pace, self._mark = (t - since) / (steps - before), (t, steps)
        if self.held:
            return self._frees(pace, t, steps)
        local = float(samples[-1, 0] - samples[0, 0]) / (STEPS_APART * (len(samples) - 1))
        steady = pace < STEADY * local and local * self._fastest < WITHIN_PERIODS
        distance, longer = self._fit(samples) if steady else (0.0, 0.0)
        faint = distance < FAINT
        creeping = STUCK < distance < NEGLIGIBLE and (longer > (NO_LOSS if faint else GAIN)) and (faint or self._holds)
        if not creeping:
            self._next = int(LATER * steps)
            return False
        self.order, self._pace, self._briefly = HELD, pace, faint
        self._next = steps + (DAMPED_AWAY if faint else RELAPSE)
        if not faint:
            self._held.append((t, steps))
        return True

    def _frees(self, pace: float, t: float, steps: int) -> bool:
        """Whether the order held has not paid, or has been held for long enough."""
        pays = not self._briefly and pace > GAIN * self._pace
        if pays and steps < self._held[-1][1] + self._stretch:
            self._next = steps + RELAPSE
            return False
        if not self._briefly:
            self._stretch *= LONGER
            self._held_steps += steps - self._held[-1][1]
        self.order, self._next = self._highest, steps + (RELAPSE if pays or self._briefly else steps)
        return True

    def _fit(self, samples: np.ndarray) -> tuple[float, float]:
        """Distance from the polynomial that fits best, in units of the tolerance, and how much longer a step of the held order may be.

        Five samples mostly show that they are far from it: then the second figure is 0.
        """
        least, distance, highest = cubic_fit(samples, self._rtol, self._atol)
        if least > NEGLIGIBLE:
            return least, 0.0
        half = STEPS_APART * (len(samples) - 1) / 2  # steps in a unit of the cubic's variable
        third = 6 * highest / half**3
        longer = (MARGIN / (ERROR_CONSTANT * third)) ** (1 / 3) if third > 0 else math.inf
        return distance, longer

    def note(self, steps: int) -> str:
        """What was done, for the user, after so many steps of the run; empty for nothing."""
        if not self._held:
            return ""
        held = self._held_steps + (steps - self._held[-1][1] if self.held and not self._briefly else 0)
        first, before = self._held[0]
        return (
            f"from t = {first:.4g} s on BDF's order was held at {HELD} for {held} of {steps} steps: orders 3 to 5 had crept along "
            f"a stiff, little damped vibration of less than {NEGLIGIBLE:g} tolerances, {before} steps up to there; it is now damped "
            "away, also in forces; a smaller rtol, or max_order: 5, keeps it"
        )

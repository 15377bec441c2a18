"""Detection of BDF steps of order 3 to 5 that are limited by stability at a negligible vibration.

These formulas are not stable near the imaginary axis (Hairer, Wanner, Solving Ordinary Differential Equations II, ch.
V.1).  Longer steps let a stiff, lightly damped vibration grow to the tolerance, and the error test shortens them again.
Order 2 damps the vibration.  CVODE detects such growth at constant steps (STALD); IDA has no such test.  Here, the sign
is that many successive steps follow a cubic within some tolerances.

Order 2 has larger errors in the slow motion.  So the order is limited only if steps become much longer, as the third
derivative of the cubic predicts.  A vibration of a few tolerances is damped within a hundred steps of order 2.
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
"""States in a check, and steps between them.  Motions resolved by order 3 to 5 are much further from a cubic."""
FAR_APART = np.array([0, 4, 8, 12, 15], dtype=np.int64)
"""States compared first; they usually suffice to show that the motion is far from a cubic."""
NEGLIGIBLE = 150.0
"""Distance from the cubic, in tolerances, up to which a vibration is negligible; higher orders damp it too."""
STUCK, STEADY = 0.5, 3.0
"""Distance from the cubic below which, and ratio of the mean to the current step above which, steps have another
limit."""
FAINT, DAMPED_AWAY = 4.0, 100
"""Distance up to which a vibration is faint, and steps of order 2 that damp a faint vibration."""
WITHIN_PERIODS = 12.0
"""Longest step, times a bound of the fastest rate, that stability may limit; a restart with longer ones would excite
vibrations that are already damped."""
FIRST_LOOK, LATER = 2000, 1.5
"""Steps before the first check, and growth factor of that number for later ones."""
RELAPSE, STRETCH, LONGER = 2000, 2000, 4
"""Steps between checks while the order is limited; steps of the first limitation, and growth factor for later ones."""
GAIN = 3.0
"""Factor by which the limited order must lengthen steps: predicted beforehand, measured afterwards.  It pays for the
larger errors of order 2."""
NO_LOSS = 1.5
"""Predicted factor required for a faint vibration: steps become longer after it is damped."""
MARGIN, ERROR_CONSTANT = 0.1, 2 / 9
"""Error of a step that the integrator aims at, relative to the tolerance, and error constant of BDF of order 2."""
TIGHTEST_HELD = 1e-7
"""Relative tolerance below which the order is limited only briefly, because order 2 would be too inaccurate."""
HELD, HIGHEST = 2, 5
"""Highest A-stable order, and highest order of BDF."""


def cubic_fit(samples: np.ndarray, rtol: float, atol: np.ndarray) -> tuple[float, float, float]:
    """Return the distances of states from the best-fitting cubics, in units of the tolerance.

    Parameters
    ----------
    samples : ndarray, shape (`STATES_LOOKED_AT`, 1 + n)
        Times and states.
    rtol : float
    atol : ndarray, shape (n,)

    Returns
    -------
    least : float
        Distance shown by the states `FAR_APART`.
    distance : float
        Largest RMS distance of one state; not computed if `least` exceeds `NEGLIGIBLE`.
    highest : float
        RMS of the cubic coefficients, with times scaled to -1 to 1; not computed either in that case.
    """
    count, n = len(samples), samples.shape[1] - 1
    samples, work, found = np.ascontiguousarray(samples), np.empty(n + 6 * count + 8), np.zeros(3)
    rows, at_atol, few, at_work, at_found = addresses(samples, atol, FAR_APART, work, found)
    CUBIC.short_call(count, n, rows, rtol, at_atol, len(FAR_APART), few, NEGLIGIBLE, at_work, at_found)
    least, distance, highest = found.tolist()
    return least, distance, highest


class StabilityLimitDetection:
    """Decision when to limit the order of BDF and when to free it again.

    Parameters
    ----------
    equations : Equations
    settings : RunSettings

    Attributes
    ----------
    order : int
        Highest order allowed.
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
        """Return True if the order is limited."""
        return self.order < self._highest

    def begin(self, t: float, steps: int, fastest: float) -> None:
        """Note a start or restart of the integrator, with vibrations of rates up to `fastest`, 1/s."""
        self._mark, self._fastest = (t, steps), fastest

    def due(self, steps: int) -> bool:
        """Return True if a check is due after `steps` steps of the run."""
        return steps >= self._next and self._watches

    def wait(self, steps: int) -> int:
        """Return the number of steps until the next check is due."""
        return self._next - steps if self._watches and self._next > steps else FIRST_LOOK

    def changed(self, samples: np.ndarray, steps: int) -> bool:
        """Check the last steps; return True if the highest order changes.

        Parameters
        ----------
        samples : ndarray, shape (n, 1 + 2 * independent)
            Time, independent coordinates and velocities after some of the last steps.
        steps : int
            Number of steps of the run.
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
        """Return True if the order is to be freed: the limit has not paid, or has lasted long enough."""
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
        """Return the distance from the best-fitting cubic, in tolerances, and the predicted factor in step size.

        The second is 0 if a few samples show that the motion is far from a cubic.
        """
        least, distance, highest = cubic_fit(samples, self._rtol, self._atol)
        if least > NEGLIGIBLE:
            return least, 0.0
        half = STEPS_APART * (len(samples) - 1) / 2  # steps in a unit of the cubic's variable
        third = 6 * highest / half**3
        longer = (MARGIN / (ERROR_CONSTANT * third)) ** (1 / 3) if third > 0 else math.inf
        return distance, longer

    def note(self, steps: int) -> str:
        """Return a sentence on the limited order for the user, after `steps` steps; empty if it was never limited."""
        if not self._held:
            return ""
        held = self._held_steps + (steps - self._held[-1][1] if self.held and not self._briefly else 0)
        first, before = self._held[0]
        return (
            f"from t = {first:.4g} s on BDF's order was held at {HELD} for {held} of {steps} steps: orders 3 to 5 had crept along "
            f"a stiff, little damped vibration of less than {NEGLIGIBLE:g} tolerances, {before} steps up to there; it is now damped "
            "away, also in forces; a smaller rtol, or max_order: 5, keeps it"
        )

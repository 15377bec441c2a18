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
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from ...compile.equations import Equations
from ...model.settings import RunSettings
from ...tuning import tuned
from ..ida.native.parameters import LOOP
from .native.parameters import A_STABLE_ORDER
from .tolerances import independent_tolerances

HIGHEST_ORDER: Final = 5
"""Highest order of BDF in IDA: higher ones are unstable or nearly so."""
ERROR_CONSTANT = 1 / ((A_STABLE_ORDER + 1) * sum(1 / k for k in range(1, A_STABLE_ORDER + 1)))
"""Error constant of BDF of order 2."""


@dataclass(frozen=True)
class StabilityLimitParameters:
    """Parameters that decide when the order of BDF is limited.

    Source: numbers of steps of ``tests/solve/ida/test_order_watch.py`` and of the stress tests ``order_collapse``.
    """

    interval: int = 2000
    """Steps before the first check, steps of a limitation, and steps to the next check after it."""
    growth: float = 1.5
    """Ratio of the numbers of steps at successive checks without a limitation."""
    least_distance: float = 0.5
    """Distance of the samples from the best-fitting cubics, in tolerances, below which no vibration is present: another
    bound, such as `max_step`, limits the steps."""
    faint: float = 4.0
    """Distance, in tolerances, below which a vibration is faint: few steps of order 2 damp it."""
    negligible: float = 150.0
    """Distance, in tolerances, below which a vibration is negligible; higher orders damp it too."""
    damping_steps: int = 100
    """Steps of order 2 that damp a faint vibration."""
    gain: float = 3.0
    """Factor by which the limited order must lengthen steps: predicted beforehand, measured afterwards. It pays for the
    larger errors of order 2."""
    gain_if_faint: float = 1.5
    """Predicted factor required for a faint vibration: steps become longer after it is damped."""
    step_error: float = 0.1
    """Error of a step that the integrator aims at, relative to the tolerance."""


STABILITY_LIMIT = tuned("stability_limit", StabilityLimitParameters())


class CubicFit(NamedTuple):
    """Comparison of the last states with the best-fitting cubics, in units of the tolerance.

    `distance`: largest RMS distance of one state. `third`: RMS of the cubic coefficients, with times scaled to -1 to 1.
    """

    distance: float
    third: float


class Limitation(NamedTuple):
    """Limitation of the order.

    `t`: time of its beginning, s. `steps`: steps of the run up to there. `step`: mean step before, s. `faint`: True if
    the vibration was faint.
    """

    t: float
    steps: int
    step: float
    faint: bool


def cubic_fit(samples: np.ndarray, rtol: float, atol: np.ndarray) -> CubicFit:
    """Return the distances of states from the best-fitting cubics.

    `samples` of shape (`LOOP.samples`, 1 + n): times and states. `atol` of shape (n,).
    """
    t, rows = samples[:, 0], samples[:, 1:] / (rtol * np.abs(samples[-1, 1:]) + atol)
    powers = np.vander(2.0 * (t - t[0]) / (t[-1] - t[0]) - 1.0, 4)
    found, *_ = np.linalg.lstsq(powers, rows, rcond=None)
    squares = np.mean((rows - powers @ found) ** 2, axis=1)
    return CubicFit(float(np.sqrt(squares.max())), float(np.sqrt(np.mean(found[0] ** 2))))


def predicted_gain(fit: CubicFit, parameters: StabilityLimitParameters) -> float:
    """Return the ratio of steps of order 2 to the current steps, from the third derivative of the cubics."""
    steps = LOOP.steps_apart * (LOOP.samples - 1) / 2  # in a unit of the cubic's variable
    derivative = 6 * fit.third / steps**3
    if not derivative > 0:
        return math.inf
    return (parameters.step_error / (ERROR_CONSTANT * derivative)) ** (1 / 3)


def limits_steps(fit: CubicFit, parameters: StabilityLimitParameters) -> bool:
    """Return True if a negligible vibration limits the steps by stability, and order 2 would lengthen them enough."""
    required = parameters.gain_if_faint if fit.distance < parameters.faint else parameters.gain
    vibrates = parameters.least_distance < fit.distance < parameters.negligible
    return vibrates and predicted_gain(fit, parameters) > required


class StabilityLimitDetection:
    """Decision when to limit the order of BDF and when to free it again.

    `is_active`: False if the order is never limited. `order`: highest order allowed.
    """

    def __init__(self, equations: Equations, settings: RunSettings, is_active: bool = True) -> None:
        self._equations, self._settings, self._is_active = equations, settings, is_active
        self._parameters = STABILITY_LIMIT
        self._highest = settings.max_order or HIGHEST_ORDER
        self.order = self._highest
        self._next_check = self._parameters.interval  # in steps of the run
        self._limitations: list[Limitation] = []
        self._limited_steps = 0  # without those for faint vibrations
        self._since = 0.0, 0  # time and steps at the last start or check

    @cached_property
    def _atol(self) -> np.ndarray:
        return independent_tolerances(self._equations, self._settings)

    def forget(self) -> None:
        """Begin a new run."""
        self.order, self._next_check = self._highest, self._parameters.interval
        self._limitations, self._limited_steps, self._since = [], 0, (0.0, 0)

    @property
    def held(self) -> bool:
        """Return True if the order is limited."""
        return self.order < self._highest

    def begin(self, t: float, steps: int) -> None:
        """Note a start or restart of the integrator at t, s."""
        self._since = t, steps

    def due(self, steps: int) -> bool:
        """Return True if a check is due after `steps` steps of the run."""
        return self._is_active and steps >= self._next_check

    def wait(self, steps: int) -> int:
        """Return the number of steps until the next check is due."""
        if not self._is_active:
            return LOOP.most_steps
        return self._next_check - steps if self._next_check > steps else self._parameters.interval

    def changed(self, samples: np.ndarray, steps: int) -> bool:
        """Check the last steps; return True if the highest order changes.

        `samples` of shape (n, 1 + 2 * independent): time, independent coordinates and velocities after some of the last
        steps. `steps`: number of steps of the run.
        """
        if len(samples) < LOOP.samples:
            return False
        t, (t_before, steps_before) = float(samples[-1, 0]), self._since
        step, self._since = (t - t_before) / (steps - steps_before), (t, steps)
        if self.held:
            self._free(step, steps)
            return True
        fit = cubic_fit(samples, self._settings.rtol, self._atol)
        if not limits_steps(fit, self._parameters):
            self._next_check = int(self._parameters.growth * steps)
            return False
        self._limit(Limitation(t, steps, step, fit.distance < self._parameters.faint))
        return True

    def _limit(self, limitation: Limitation) -> None:
        self.order = A_STABLE_ORDER
        self._limitations.append(limitation)
        duration = self._parameters.damping_steps if limitation.faint else self._parameters.interval
        self._next_check = limitation.steps + duration

    def _free(self, step: float, steps: int) -> None:
        """Free the order; if its limitation has not paid, the next check is due after twice as many steps."""
        last = self._limitations[-1]
        self.order = self._highest
        self._limited_steps += 0 if last.faint else steps - last.steps
        pays = last.faint or step > self._parameters.gain * last.step
        self._next_check = steps + (self._parameters.interval if pays else steps)

    def note(self, steps: int) -> str:
        """Return a sentence on the limited order for the user, after `steps` steps; empty if it was never limited."""
        reported = [limitation for limitation in self._limitations if not limitation.faint]
        if not reported:
            return ""
        first, last = reported[0], self._limitations[-1]
        limited = self._limited_steps + (steps - last.steps if self.held and not last.faint else 0)
        return (
            f"from t = {first.t:.4g} s on the order of BDF was limited to {A_STABLE_ORDER} for {limited} of {steps} steps: a stiff, "
            f"lightly damped vibration of less than {self._parameters.negligible:g} tolerances had limited the steps of orders 3 to 5 "
            f"({first.steps} steps up to there); it is now damped numerically, also in forces; a smaller rtol, or max_order: 5, keeps it"
        )

"""Handling metrics of the standards, from time histories in SI units and the axes of ISO 8855."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import InputError

LINEAR = 4.0
"""Lateral acceleration up to which the gradients at zero are fitted, m/s^2."""
UNEQUAL = 1e-6
"""Difference of time steps, relative to the longest, above which they are not equal: more than rounding of files."""


def at_zero(x: np.ndarray, y: np.ndarray, limit: float = LINEAR) -> tuple[float, float]:
    """Return y and dy/dx at a lateral acceleration x of 0 by a fit: a constant, and x, x|x|, x^3 and x^3|x|.

    Turns to the left and to the right are alike, so that only odd functions belong to a car. The force of a brush tyre (Fiala)
    contains a|a|. The fit is over abs(x) <= limit, and over half of the range of x: near their limits, tyres follow no polynomial.

    Raises
    ------
    InputError
        If fewer than five values lie within the limit.
    """
    limit = min(limit, 0.5 * float(np.max(np.abs(x), initial=0.0)))
    inside = np.abs(x) <= limit
    if np.count_nonzero(inside) < 5:
        raise InputError(
            f"found {np.count_nonzero(inside)} lateral accelerations up to {limit:g} m/s^2 in steady turns, expected 5 or more"
        )
    part = x[inside] / limit
    terms = np.stack([np.ones_like(part), part, part * np.abs(part), part**3, part**3 * np.abs(part)], axis=1)
    value, slope = np.linalg.lstsq(terms, y[inside], rcond=None)[0][:2]
    return float(value), float(slope / limit)


def understeer_gradient(
    lateral_acceleration: np.ndarray, steer: np.ndarray, ratio: float, wheelbase: float = 0.0, curvature: Any = 0.0
) -> float:
    """Return the understeer gradient of ISO 4138 at zero lateral acceleration, rad/(m/s^2).

    Parameters
    ----------
    lateral_acceleration, steer : ndarray, shape (n,)
        Quasi-steady turns, m/s^2, and the steering-wheel angle, rad, or the travel of a rack, m.
    ratio : float
        Steer angle of the wheels per steering-wheel angle or travel.
    wheelbase : float
        m; not needed at constant curvature.
    curvature : float or ndarray, shape (n,)
        Curvature of the path, yaw rate over speed, 1/m: L times it, the kinematic steer angle, is subtracted.
    """
    return at_zero(lateral_acceleration, ratio * steer - wheelbase * curvature)[1]


@dataclass(frozen=True)
class StepResponse:
    """Response to a step input, ISO 7401."""

    # steady, gain: mean over the end, and its ratio to the input
    steady: float
    gain: float
    # response_time, peak_time: from half of the input to 90 % of the steady value, and to the peak, s
    response_time: float
    peak_time: float
    overshoot: float  # (peak - steady)/steady


def step_response(time: np.ndarray, steer: np.ndarray, response: np.ndarray, settled: float = 0.5) -> StepResponse:
    """Return the response times, overshoot and gain of ISO 7401 for a step input from zero.

    Parameters
    ----------
    time, steer, response : ndarray, shape (n,)
        The input may be negative; the response counts in the direction of its steady value.
    settled : float
        Length of the end over which the steady values are averaged, s.

    Raises
    ------
    InputError
        If input or response stay zero.
    """
    end = time >= time[-1] - settled
    final, steady = float(np.mean(steer[end])), float(np.mean(response[end]))
    if final == 0.0 or steady == 0.0:
        raise InputError("found no step of the input or no response to it, expected non-zero final values of both")
    start = first_time(time, steer / final, 0.5)
    part = response / steady
    after = time >= start
    peak = int(np.argmax(np.where(after, part, -np.inf)))
    return StepResponse(
        steady, steady / final, first_time(time, np.where(after, part, 0.0), 0.9) - start, float(time[peak]) - start,
        float(part[peak]) - 1.0,
    )  # fmt: skip


def first_time(time: np.ndarray, values: np.ndarray, level: float) -> float:
    """Return the first time at which values rise to a level, by linear interpolation; NaN without one."""
    above = np.flatnonzero(values >= level)
    if not len(above):
        return float("nan")
    k = int(above[0])
    if k == 0:
        return float(time[0])
    part = (level - values[k - 1]) / (values[k] - values[k - 1])
    return float(time[k - 1] + part * (time[k] - time[k - 1]))


def _at(time: np.ndarray, values: np.ndarray, t: float) -> float:
    """Return a value at a time, s. Raises InputError if the run does not last until then."""
    if not time[0] <= t <= time[-1] + 1e-9 * (time[-1] - time[0]):
        raise InputError(f"found times from {time[0]:.6g} to {time[-1]:.6g} s, expected values at {t:.6g} s")
    return float(np.interp(t, time, values))


@dataclass(frozen=True)
class FrequencyResponse:
    """Frequency response with its error bars, arrays of shape (n,)."""

    # frequency, gain, phase, coherence: Hz; ratio of amplitudes; rad, negative for a lag; between 0 and 1
    frequency: np.ndarray
    gain: np.ndarray
    phase: np.ndarray
    coherence: np.ndarray
    # error: error bar of the complex response relative to the gain: that of the gain, and that of the phase in rad
    error: np.ndarray

    def at(self, frequency: float) -> tuple[float, float]:
        """Return gain and phase at a frequency; NaN outside of the range."""
        return self._at(self.gain, frequency), self._at(self.phase, frequency)

    def error_at(self, frequency: float) -> float:
        """Return the error bar at a frequency, relative to the gain, which is that of the phase in rad."""
        return self._at(self.error, frequency)

    def _at(self, values: np.ndarray, frequency: float) -> float:
        return float(np.interp(frequency, self.frequency, values, left=np.nan, right=np.nan))


AT_REST = 1e-3
"""Largest difference of the ends of a record from its start, relative to its range, after which it counts as at rest."""


def frequency_response(
    time: np.ndarray, steer: np.ndarray, response: np.ndarray, segment: float = 10.0
) -> FrequencyResponse:
    """Return the frequency response of ISO 7401 from a sweep, a pulse or a random input.

    The transform of the response over the whole record is H(f) times that of the input. H is fitted by a parabola over
    frequencies within 1/segment on both sides, which averages noise and harmonics. If the record does not end at rest, the
    transform of what follows its end is fitted, too. The error bar is twice the standard deviation of the fit, and its
    difference from a fit of the fourth degree over twice the range. Pintelon, Schoukens, Vandersteen, Barbe, Estimation of
    nonparametric noise and FRF models for multivariable systems, Mech. Systems and Signal Processing 24 (2010) 573-595.

    Parameters
    ----------
    time, steer, response : ndarray, shape (n,)
        At equal time steps. Records that begin and end at rest give the most accurate responses.
    segment : float
        Reciprocal of the resolution, s: longer ones resolve sharper resonances, and average less. The record must last
        three times as long.

    Raises
    ------
    InputError
        If the time steps are not equal, or the record is too short.
    """
    steps = np.diff(time)
    if np.ptp(steps) > UNEQUAL * np.max(steps):
        raise InputError(
            f"found time steps from {steps.min():.3g} to {steps.max():.3g} s, expected equal ones: set run.output to a fixed interval"
        )
    length = (time[-1] - time[0]) * len(time) / (len(time) - 1)
    half = round(length / segment)
    if half < 3:
        raise InputError(
            f"found a record of {length:.3g} s, expected {3 * segment:.3g} s or more, or a shorter segment"
        )
    at_rest = all(abs(x[-1] - x[0]) <= AT_REST * np.ptp(x) for x in (steer, response))
    spectra = np.fft.rfft(steer), np.fft.rfft(response)
    fits = [_local_fit(*spectra, half, degree, at_rest) for half, degree in ((half, 2), (2 * half, 4))]
    (value, deviation, coherence), (wider, *_) = (tuple(x[half:] for x in fits[0]), fits[1])
    found = value[: len(wider)]
    frequency = np.arange(2 * half + 1, 2 * half + 1 + len(found)) / length
    with np.errstate(divide="ignore", invalid="ignore"):
        error = (2 * deviation[: len(found)] + np.abs(found - wider)) / np.abs(found)
    return FrequencyResponse(frequency, np.abs(found), np.unwrap(np.angle(found)), coherence[: len(found)], error)


def _local_fit(
    steer: np.ndarray, response: np.ndarray, half: int, degree: int, at_rest: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the response at each frequency by a polynomial over its neighbours, its standard deviation and coherence.

    `half`: number of neighbours on either side. The first value is at the frequency of number half + 1.
    """
    window = np.lib.stride_tricks.sliding_window_view
    x, y = window(steer[1:], 2 * half + 1), window(response[1:], 2 * half + 1)
    powers = np.linspace(-1, 1, 2 * half + 1)[:, None] ** np.arange(degree + 1)
    rows = x[:, :, None] * powers
    if not at_rest:
        size = np.linalg.norm(x, axis=1)[:, None, None]
        rows = np.concatenate([rows, size * powers[None]], axis=2)
    inverse = np.linalg.pinv(rows)
    fit = np.einsum("nij,nj->ni", inverse, y)
    left = y - np.einsum("nij,nj->ni", rows, fit)
    power = np.sum(np.abs(left) ** 2, axis=1)
    variance = power / max(y.shape[1] - rows.shape[2], 1) * np.sum(np.abs(inverse[:, 0]) ** 2, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        coherence = 1 - power / np.sum(np.abs(y) ** 2, axis=1)
    return fit[:, 0], np.sqrt(variance), coherence


STABLE = 0.35, 0.2
"""Largest yaw rate ratios of a stable car 1 s and 1.75 s after the end of steering. ISO 19365."""


@dataclass(frozen=True)
class SineWithDwell:
    """Stability and responsiveness of ISO 19365."""

    # ratio_1, ratio_1_75: yaw rate 1 s and 1.75 s after the end of steering, relative to its peak in the second half of
    # the sine
    ratio_1: float
    ratio_1_75: float
    # lateral displacement 1.07 s after the begin of steering, at 5 deg of the steering wheel, m, positive in the direction of the first steering
    displacement: float

    @property
    def stable(self) -> bool:
        """Return True if the yaw rate in either direction has fallen to 35 % after 1 s and to 20 % after 1.75 s."""
        return abs(self.ratio_1) <= STABLE[0] and abs(self.ratio_1_75) <= STABLE[1]


def sine_with_dwell(
    time: np.ndarray, steer: np.ndarray, yaw_rate: np.ndarray, lateral: np.ndarray, begin: float, end: float
) -> SineWithDwell:
    """Return the metrics of ISO 19365.

    Parameters
    ----------
    time, steer, yaw_rate : ndarray, shape (n,)
    lateral : ndarray, shape (n,)
        Lateral displacement of the vehicle from its straight path, m, positive to the left.
    begin, end : float
        Begin and end of steering, s: ISO 19365 counts from 5 deg of the steering wheel.

    Raises
    ------
    InputError
        If the run ends less than 1.75 s after steering.
    """
    sign = np.sign(steer[np.argmax((time >= begin) & (np.abs(steer) > 0.1 * np.max(np.abs(steer))))])
    reversed_steer = (time >= begin) & (sign * steer < 0)
    peak = float(np.max(-sign * yaw_rate[reversed_steer | (time > end)]))
    first, second = (_at(time, -sign * yaw_rate, end + after) / peak for after in (1.0, 1.75))
    displacement = sign * (_at(time, lateral, begin + 1.07) - _at(time, lateral, begin))
    return SineWithDwell(first, second, displacement)


def mean_deceleration(time: np.ndarray, speed: np.ndarray) -> float:
    """Return the mean fully developed deceleration of ISO 21994: (v1^2 - v2^2)/(2 s) from 80 % to 10 % of the speed, m/s^2.

    Raises
    ------
    InputError
        If the speed does not fall to 10 % of the first one.
    """
    distance = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * np.diff(time))])
    first, second = (first_time(time, speed[0] - speed, (1 - part) * speed[0]) for part in (0.8, 0.1))
    if not np.isfinite(second):
        raise InputError(f"found a lowest speed of {speed.min():.3g} m/s, expected {0.1 * speed[0]:.3g} m/s or less")
    braking_distance = np.interp(second, time, distance) - np.interp(first, time, distance)
    return float((0.8**2 - 0.1**2) * speed[0] ** 2 / (2 * braking_distance))


def yaw_rate_ratio(
    time: np.ndarray, yaw_rate: np.ndarray, speed: np.ndarray, begin: float, after: float = 1.0
) -> float:
    """Return the yaw rate at a time `after` braking begins, s, relative to that on the initial radius (ISO 7975).

    The reference is the yaw rate of the initial curvature at the current speed: 1 means that the car keeps its radius.
    Raises InputError if the run ends before.
    """
    rate, v = _at(time, yaw_rate, begin + after), _at(time, speed, begin + after)
    return rate / (_at(time, yaw_rate, begin) / _at(time, speed, begin) * v)


def static_stability_factor(track: float, height: float) -> float:
    """Return T/(2 h), the lateral acceleration in g at which a rigid vehicle tips."""
    return track / (2 * height)


def rollover_threshold(lateral_acceleration: np.ndarray, inner_loads: np.ndarray) -> float:
    """Return the lateral acceleration at which the last inner wheel lifts off, m/s^2; NaN if it does not.

    Parameters
    ----------
    lateral_acceleration : ndarray, shape (n,)
        Magnitude, slowly increasing, m/s^2.
    inner_loads : ndarray, shape (n, wheels)
        Loads of the inner wheels, N.
    """
    lifted = np.all(inner_loads <= 0.0, axis=1)
    return float(lateral_acceleration[np.argmax(lifted)]) if lifted.any() else float("nan")

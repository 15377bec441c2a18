"""Ride metrics: frequency weightings of ISO 2631-1, weighted root mean squares, power spectra and transmissibility."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from ...reading.did_you_mean import instead_of

NONE = np.inf
"""Frequency of a filter that is left out, Hz."""


@dataclass(frozen=True)
class Weighting:
    """Parameters of a frequency weighting, ISO 2631-1:1997, table A.1; frequencies in Hz."""

    # f3, f4, q4: transition from acceleration to velocity; infinite f3 and f4 leave it out
    f3: float
    f4: float
    q4: float
    # f5, q5, f6, q6: upward step; infinite f5 and f6 leave it out
    f5: float = NONE
    q5: float = 1.0
    f6: float = NONE
    q6: float = 1.0
    # f1, f2: band limits
    f1: float = 0.4
    f2: float = 100.0

    def response(self, frequency: np.ndarray) -> np.ndarray:
        """Return the complex frequency response at frequencies in Hz, shape (n,)."""
        p = 1j * np.asarray(frequency, dtype=float)
        root = np.sqrt(2.0)
        high = p**2 / (p**2 + root * self.f1 * p + self.f1**2)
        low = 1 / (1 + root * p / self.f2 + (p / self.f2) ** 2)
        found = high * low
        if np.isfinite(self.f3):
            found = found * (1 + p / self.f3) / (1 + p / (self.q4 * self.f4) + (p / self.f4) ** 2)
        if np.isfinite(self.f5):
            step = (1 + p / (self.q5 * self.f5) + (p / self.f5) ** 2) / (
                1 + p / (self.q6 * self.f6) + (p / self.f6) ** 2
            )
            found = found * step * (self.f5 / self.f6) ** 2
        return found


WEIGHTINGS = {
    "Wk": Weighting(12.5, 12.5, 0.63, 2.37, 0.91, 3.35, 0.91),
    "Wd": Weighting(2.0, 2.0, 0.63),
    "Wc": Weighting(8.0, 8.0, 0.63),
    "We": Weighting(1.0, 1.0, 0.63),
    "Wj": Weighting(np.inf, np.inf, 1.0, 3.75, 0.91, 5.32, 0.91),
}
"""Weightings by name: Wk for vertical, Wd for horizontal vibration of a seated person."""


def weighted(acceleration: np.ndarray, step: float, weighting: str) -> np.ndarray:
    """Return a frequency-weighted acceleration, m/s^2, by multiplication in the frequency domain.

    Parameters
    ----------
    acceleration : ndarray, shape (n,)
        At equal time steps, m/s^2.
    step : float
        Time step, s.
    weighting : str
        Name among `WEIGHTINGS`.

    Raises
    ------
    InputError
        If there is no such weighting.
    """
    if weighting not in WEIGHTINGS:
        raise InputError(f"found the weighting '{weighting}'{instead_of(weighting, WEIGHTINGS)}")
    count = len(acceleration)
    spectrum = np.fft.rfft(acceleration - np.mean(acceleration))
    return np.fft.irfft(spectrum * WEIGHTINGS[weighting].response(np.fft.rfftfreq(count, step)), count)


def weighted_rms(acceleration: np.ndarray, step: float, weighting: str) -> float:
    """Return the frequency-weighted root mean square acceleration of ISO 2631-1, m/s^2; see `weighted`."""
    return float(np.sqrt(np.mean(weighted(acceleration, step, weighting) ** 2)))


def total_vibration(x: float, y: float, z: float) -> float:
    """Return the vibration total value of weighted accelerations for comfort, with all factors k = 1, m/s^2."""
    return float(np.sqrt(x**2 + y**2 + z**2))


def power_spectrum(values: np.ndarray, step: float, segment: float = 5.0) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies, Hz, and the one-sided power spectral density by Welch's method, in the unit squared per Hz."""
    from scipy.signal import welch

    return welch(values, 1 / step, nperseg=min(len(values), round(segment / step)))  # type: ignore[no-any-return]


def transmissibility(
    source: np.ndarray, answer: np.ndarray, step: float, segment: float = 5.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies, Hz, and the square root of the ratio of the spectral densities of an answer and its source."""
    frequency, below = power_spectrum(source, step, segment)
    above = power_spectrum(answer, step, segment)[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return frequency, np.sqrt(above / below)

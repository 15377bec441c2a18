"""Period of a channel, and its last cycle.

References
----------
de Cheveigne and Kawahara, YIN, a fundamental frequency estimator for speech and music, J. Acoust. Soc. Am. 111 (2002),
steps 2 to 5: differences of a signal from itself at a lag, relative to their mean over all smaller lags.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..results.channels import named
from ..results.solution import Solution
from .parameters import EVALUATION


@dataclass(frozen=True, eq=False)
class Cycle:
    """Last cycle of a channel.

    Attributes
    ----------
    period : float
        Duration, s.
    rows : ndarray of int
        Output instants of the last cycle at which the value is known.
    change : float
        Largest difference from the cycle before, relative to the range of the channel in both: near zero in a steady state.
    """

    period: float
    rows: np.ndarray
    change: float


def cycle(solution: Solution, channel: str) -> Cycle | None:
    """Return the last cycle of a channel; None if the run has no two cycles that are alike.

    Raises
    ------
    InputError
        If there is no such channel.

    Examples
    --------
    >>> import stiffmbs
    >>> crank = stiffmbs.run("examples/elastic_bearing.yaml", rtol=1e-6)
    >>> found = stiffmbs.cycle(crank, "shaft.fy")
    >>> print(f"{60/found.period:.0f} rpm, {abs(crank['shaft.fy'][found.rows]).max():.0f} N at most in the last cycle")
    3000 rpm, 1217 N at most in the last cycle
    """
    t, values = solution.time, named(solution.channels, channel)
    known = np.isfinite(values)
    if not known.any() or not np.ptp(values[known]) > 0:
        return None
    even = np.linspace(t[known][0], t[known][-1], EVALUATION.samples * len(t))
    x = np.interp(even, t[known], values[known])
    lag = _first_lag(x)
    if lag is None:
        return None
    period = lag * float(even[1] - even[0])
    last = even[even >= even[-1] - period]
    now, before = np.interp(last, even, x), np.interp(last - period, even, x)
    size = float(np.ptp(np.concatenate([now, before])))
    if not size > 0:  # constant at last
        return None
    rows = np.flatnonzero(known & (t >= even[-1] - period))
    return Cycle(period, rows, float(np.max(np.abs(now - before))) / size)


def _first_lag(x: np.ndarray) -> float | None:
    """Return the smallest lag at which the end of a signal repeats, in samples; None if there is none."""
    longest = len(x) // 2 + 2  # the difference at half of the run has neighbours
    differences = _differences(x[::-1] - x.mean(), longest)
    lags = np.arange(1, longest + 1)
    relative = differences[1:] * lags / np.maximum(np.cumsum(differences[1:]), np.finfo(float).tiny)
    below = np.flatnonzero(relative < EVALUATION.alike)
    if not len(below):
        return None
    k = int(below[0])
    while k + 1 < longest and relative[k + 1] < relative[k]:
        k += 1
    if not 0 < k < longest - 1:
        return None
    left, middle, right = differences[k : k + 3]
    bend = left - 2.0 * middle + right
    return float(lags[k] + (0.5 * (left - right) / bend if bend > 0 else 0.0))


def _differences(x: np.ndarray, longest: int) -> np.ndarray:
    """Return the sums of squared differences of the beginning of a signal from itself, at all lags up to the longest."""
    size, count = 2 ** int(np.ceil(np.log2(2 * len(x)))), len(x) - longest
    products = np.fft.irfft(np.conj(np.fft.rfft(x[:count], size)) * np.fft.rfft(x, size), size)[: longest + 1]
    squares = np.append(0.0, np.cumsum(x * x))
    lagged = squares[count : count + longest + 1] - squares[: longest + 1]
    return np.maximum(squares[count] + lagged - 2.0 * products, 0.0)

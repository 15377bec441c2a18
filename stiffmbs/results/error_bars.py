"""How far the peaks of a channel, and its values over time, may lie from the truth: what several runs say of one.

Of a run y0 and better ones y1, y2, ... at the same instants, the error of y0 is about y0 - y1: exactly so but for the
error of y1 (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, 1993, ch. II.4).  Where a better run
has at most half the error of y0, twice the largest difference bounds it.

A difference of two peaks is a single number, and may be small by accident: where y0 comes close to the truth on its
way from one side to the other, y1 may have the same error.  With errors normally distributed, r times as large in y1 as in
y0, twice the difference is too small for 0.42 r of the peaks, and k times too small for a k-th of these: their ratio has
a Cauchy distribution.  So y1 has to be much better than y0, and a further run made in another way has to agree: that
both err as y0 does is rare in proportion to the product.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Fine = tuple[np.ndarray, np.ndarray, np.ndarray]
SAFETY = 2.0
"""Times the difference: right where a better run has half the error at most."""
LEVEL = 1e-300
"""Curvature below which a peak is as good as flat."""
FINER = 1.1
"""Times what finer instants show: the finest show a little more."""


@dataclass(frozen=True)
class ErrorBar:
    """What is not known of one channel, in its own unit; NaN where nothing is known.

    Attributes
    ----------
    over_time : float
        Largest error at an output instant.
    least, greatest : float
        Half widths of the bars of the channel's least and greatest value: error of the solver, and what the channel
        may reach between output instants.
    sampled_least, sampled_greatest : float
        The latter part alone.
    """

    over_time: float
    least: float
    greatest: float
    sampled_least: float = 0.0
    sampled_greatest: float = 0.0


UNKNOWN = ErrorBar(np.nan, np.nan, np.nan)


def error_bar(values: np.ndarray, others: Sequence[np.ndarray], fine: Fine | None, rounding: float) -> ErrorBar:
    """The error bar of one channel.

    Parameters
    ----------
    values : ndarray, shape (n,)
        As reported; instants without a value are passed over, here and in all else.
    others : sequence of ndarray, shapes (m,), m <= n
        From better runs at the same instants, shorter where they ended before.
    fine : (ndarray, ndarray, ndarray of int), optional
        Instants, s, values there, and which of them are reported: of a run that looks between the reported ones.
    rounding : float
        What nobody knows better.

    Returns
    -------
    ErrorBar
    """
    if not others and fine is None:
        return UNKNOWN
    whole = [float(np.nanmax(np.abs(values - o))) for o in others if len(o) == len(values)]
    over_time = max([0.0, *whole]) if whole or not others else np.nan
    least, sampled_least = _bar_of_maximum(-values, [-o for o in others], fine and (fine[0], -fine[1], fine[2]))
    greatest, sampled_greatest = _bar_of_maximum(values, others, fine)
    return ErrorBar(
        SAFETY * over_time + rounding, least + rounding, greatest + rounding, sampled_least, sampled_greatest
    )


def _bar_of_maximum(values: np.ndarray, others: Sequence[np.ndarray], fine: Fine | None) -> tuple[float, float]:
    """The bar of the greatest value, and the part of it that comes from between the instants."""
    at = int(np.nanargmax(values))
    reaching = [other for other in others if len(other) > at]
    if others and not reaching:
        return np.nan, np.nan
    solver = SAFETY * max([0.0, *(abs(values[at] - float(np.nanmax(o))) for o in reaching)])
    sampled = between(*fine) if fine else 0.0
    return solver + sampled, sampled


def between(times: np.ndarray, values: np.ndarray, at: np.ndarray) -> float:
    """How much a run at many instants exceeds its values at the reported ones, up to the tops of parabolas.

    Every peak counts that has its top between two instants, for another may be the highest at those that are looked at.

    Parameters
    ----------
    times, values : ndarrays, shape (n,)
    at : ndarray of int
        Which of them are reported.
    """
    highest = float(np.nanmax(values[at]))
    k = 1 + np.flatnonzero((values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:]))
    before, after = times[k - 1] - times[k], times[k + 1] - times[k]
    fall, rise = (values[k - 1] - values[k]) / before, (values[k + 1] - values[k]) / after
    bend = np.minimum((rise - fall) / (after - before), -LEVEL)
    slope = fall - bend * before
    around = [values[np.clip(k + beside, 0, len(values) - 1)] for beside in (-2, -1, 1, 2)]
    top = np.minimum(slope**2 / (-4 * bend), values[k] - np.nanmin(around, axis=0))  # of jumps no more than these
    shown = float(np.nanmax(values)) - highest
    reached = values[k] - highest
    return max(FINER * shown, float(np.max(np.where(reached > 0, FINER, 1.0) * reached + SAFETY * top, initial=0.0)))

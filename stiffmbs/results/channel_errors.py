"""Error bars of channels from estimates of their errors over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .error_bars import UNKNOWN, ErrorBar, between
from .scales import ROUNDING, kind_of


@dataclass(frozen=True)
class ChannelErrors:
    """Values and errors of all channels at the nodes of one mechanism, by name, shape (n,); `t`, `restarts`: s."""

    t: np.ndarray
    values: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]
    restarts: np.ndarray

    def at(self, times: np.ndarray, channel: str) -> np.ndarray:
        """Return the errors of a channel at other times, by linear interpolation."""
        return np.interp(times, self.t, self.errors[channel])


def bars(times: np.ndarray, channels: dict[str, np.ndarray], parts: Sequence[ChannelErrors]) -> dict[str, ErrorBar]:
    """Return the error bars of the channels of a run from the errors along its mechanisms, one after the other in `parts`."""
    found = {}
    for name, values in channels.items():
        if name.startswith("constraint."):
            continue
        error = np.sum([part.at(times, name) for part in parts], axis=0)
        over_time = float(np.nanmax(np.abs(error), initial=0.0))
        ends = [_peak(sign * values, error, times, parts, name, sign) for sign in (-1.0, 1.0)]
        (least, sampled_least), (greatest, sampled_greatest) = ends
        found[name] = ErrorBar(over_time, least, greatest, sampled_least, sampled_greatest)
    return found


def _peak(
    values: np.ndarray, error: np.ndarray, times: np.ndarray, parts: Sequence[ChannelErrors], name: str, sign: float
) -> tuple[float, float]:
    """Return the error bar of the greatest value, and the part of it between output times."""
    if np.isnan(values).all():
        return np.nan, np.nan
    own = max(parts, key=lambda part: np.ptp(part.values[name]))  # the mechanism of the channel
    t = np.sort(np.concatenate([times, own.t]))
    t = t[np.diff(t, prepend=-np.inf) > 0.0]
    fine, at = np.interp(t, own.t, sign * own.values[name]), np.searchsorted(t, times)
    fine[at] = values
    sampled = between(t, fine, at, own.restarts)
    top = int(np.nanargmax(values))
    peak = max(abs(float(error[top])), ROUNDING * abs(float(values[top])))
    return peak + sampled, sampled


def bars_by_difference(
    times: np.ndarray, at: np.ndarray, channels: Mapping[str, np.ndarray], others: Mapping[str, np.ndarray], part: float,
    restarts: np.ndarray,
) -> dict[str, ErrorBar]:  # fmt: skip
    """Return the error bars of the channels of a run, from those of a run with another tolerance, at more times.

    `at`: places of the times of the run among `times`. `part`: error of the other run in the error of this one, as expected.
    `restarts`: times from which on channels may have jumped, s.
    """
    found = {}
    for name, values in channels.items():
        if name.startswith("constraint."):
            continue
        error = np.abs(difference(name, values, others[name][at])) / abs(1.0 - part)
        if np.isnan(error).all():
            found[name] = UNKNOWN
            continue
        fine = others[name].copy()
        fine[at] = values
        sampled = [between(times, sign * fine, at, restarts) for sign in (-1.0, 1.0)]
        least, greatest = (float(error[peak(values)]) for peak in (np.nanargmin, np.nanargmax))
        found[name] = ErrorBar(float(np.nanmax(error)), least + sampled[0], greatest + sampled[1], *sampled)
    return found


def difference(name: str, values: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return the difference of a channel in two runs; that of an angle is the one of the least turn."""
    error = values - others
    if kind_of(name) == "angle":
        error = error - 2.0 * np.pi * np.round(error / (2.0 * np.pi))
    return error

"""Error bars of channels from estimates of their errors over time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from .error_bars import UNKNOWN, ErrorBar, between
from .scales import ROUNDING, kind_of


@dataclass(frozen=True)
class ChannelErrors:
    """Errors of all channels by one mechanism, by name.

    `t`, `values`: nodes of the mechanism, s, and the values of the channels there. `errors`: those at the output times.
    `restarts`: s.
    """

    t: np.ndarray
    values: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]
    restarts: np.ndarray


def bars(
    times: np.ndarray, channels: dict[str, np.ndarray], parts: Sequence[ChannelErrors], numbers_at_once: int
) -> dict[str, ErrorBar]:
    """Return the error bars of the channels of a run from the errors along its mechanisms, one after the other in `parts`.

    `numbers_at_once`: numbers in the values of the channels that are examined together.
    """
    shown = {name: values for name, values in channels.items() if not name.startswith("constraint.")}
    sampled = _between_outputs(times, shown, parts, numbers_at_once)
    found = {}
    for name, values in shown.items():
        error = np.sum([part.errors[name] for part in parts], axis=0)
        over_time = float(np.nanmax(np.abs(error), initial=0.0))
        if name not in sampled:
            found[name] = ErrorBar(over_time, *4 * [np.nan])
            continue
        ends = int(np.nanargmin(values)), int(np.nanargmax(values))
        own = [max(abs(float(error[end])), ROUNDING * abs(float(values[end]))) for end in ends]
        least, greatest = sampled[name]
        found[name] = ErrorBar(over_time, own[0] + least, own[1] + greatest, least, greatest)
    return found


def _between_outputs(
    times: np.ndarray, channels: dict[str, np.ndarray], parts: Sequence[ChannelErrors], numbers_at_once: int
) -> dict[str, tuple[float, float]]:
    """Return by how much each channel falls below its least value, and exceeds its greatest one, between output times."""
    own: list[list[str]] = [[] for _ in parts]  # the channels of each mechanism
    for name, values in channels.items():
        if not np.isnan(values).all():
            sizes = [float(np.ptp(part.values[name])) for part in parts]
            own[sizes.index(max(sizes))].append(name)
    found: dict[str, tuple[float, float]] = {}
    for part, names in zip(parts, own, strict=True):
        t = np.sort(np.concatenate([times, part.t]))
        t = t[np.diff(t, prepend=-np.inf) > 0.0]
        at = np.searchsorted(t, times)
        rows = ((np.interp(t, part.t, part.values[name]), channels[name]) for name in names)
        found |= dict(zip(names, _both_ends(t, rows, at, part.restarts, numbers_at_once), strict=True))
    return found


def _both_ends(
    t: np.ndarray,
    rows: Iterable[tuple[np.ndarray, np.ndarray]],
    at: np.ndarray,
    restarts: np.ndarray,
    numbers_at_once: int,
) -> Iterator[tuple[float, float]]:
    """Return the excesses of `between` for the least and the greatest value of channels.

    `rows`: values at the times `t`, and those at the times of the outputs, `t[at]`.
    """
    remaining = iter(rows)
    while some := list(islice(remaining, max(1, numbers_at_once // len(t)))):
        fine = np.array([values for values, _ in some])
        fine[:, at] = [values for _, values in some]
        yield from zip(between(t, -fine, at, restarts).tolist(), between(t, fine, at, restarts).tolist(), strict=True)


def bars_by_difference(
    times: np.ndarray, at: np.ndarray, channels: Mapping[str, np.ndarray], others: Mapping[str, np.ndarray], part: float,
    restarts: np.ndarray, numbers_at_once: int,
) -> dict[str, ErrorBar]:  # fmt: skip
    """Return the error bars of the channels of a run, from those of a run with another tolerance, at more times.

    `at`: places of the times of the run among `times`. `part`: error of the other run in the error of this one, as expected.
    `restarts`: times from which on channels may have jumped, s. `numbers_at_once`: as of `bars`.
    """
    errors = {
        name: np.abs(difference(name, values, others[name][at])) / abs(1.0 - part)
        for name, values in channels.items()
        if not name.startswith("constraint.")
    }
    found = dict.fromkeys(errors, UNKNOWN)
    known = [name for name, error in errors.items() if not np.isnan(error).all()]
    ends = _both_ends(times, ((others[name], channels[name]) for name in known), at, restarts, numbers_at_once)
    for name, sampled in zip(known, ends, strict=True):
        error, values = errors[name], channels[name]
        least, greatest = (float(error[peak(values)]) for peak in (np.nanargmin, np.nanargmax))
        found[name] = ErrorBar(float(np.nanmax(error)), least + sampled[0], greatest + sampled[1], *sampled)
    return found


def difference(name: str, values: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return the difference of a channel in two runs; that of an angle is the one of the least turn."""
    error = values - others
    if kind_of(name) == "angle":
        error = error - 2.0 * np.pi * np.round(error / (2.0 * np.pi))
    return error

"""Differences of results from a listing of another program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.names import owner_of
from ..scales import ROUNDING
from ..solution import Solution
from .columns import TIME, Columns, read_columns

Listed: TypeAlias = Solution | str | Path | Mapping[str, np.ndarray]
NOT_COMPARED = (TIME, "constraint.")
"""Prefixes of channels that are equal in all runs, or noise."""


@dataclass(frozen=True)
class Difference:
    """Difference between one channel and one column.

    Attributes
    ----------
    largest : float
        Largest magnitude of the difference, in the column's units.
    t : float
        Time of the largest difference, s.
    relative : float
        Largest difference over the largest magnitude of the column, or of the channel if the column is zero.  The
        divisor is at least a billionth of the other compared components of the same element.
    """

    channel: str
    column: str
    largest: float
    t: float
    relative: float

    def as_dict(self) -> dict[str, str | float]:
        """Return an entry of ``differences`` of ``stiffmbs diff --json``."""
        return asdict(self)


def differences(found: Listed, other: Listed, columns: Mapping[str, str] | None = None) -> tuple[Difference, ...]:
    """Compare channels with columns of a listing, at its times.

    Parameters
    ----------
    found, other : Solution, str, Path or mapping
        A run or its file, and the listing; see `stiffmbs.results.listings.columns.read_columns`.  Between its own
        instants a run is interpolated by cubic splines.
    columns : mapping of str to str, optional
        Column for each channel, with a factor for other units: ``{"PART_2.x": "5*0.001"}``.  By default channels are
        compared with the columns of the same names.

    Returns
    -------
    tuple of Difference

    Raises
    ------
    InputError
        If a channel or column is missing, or the two have no times in common.
    """
    own, listed = _columns(found), _columns(other)
    pairs = columns or {
        name: name for name in own if name in listed and not name.startswith(NOT_COMPARED) and not name.isdecimal()
    }
    if not pairs:
        raise InputError(
            f"found no channel that is called like a column, expected --map CHANNEL=COLUMN; the columns are {_some(listed)}"
        )
    t, begin, end = listed[TIME], own[TIME][0], own[TIME][-1]
    slack = ROUNDING * max(abs(begin), abs(end), end - begin)
    common = (t >= begin - slack) & (t <= end + slack)
    if not common.any():
        raise InputError(
            f"found times from {t[0]:g} to {t[-1]:g} s beside {begin:g} to {end:g} s, expected some in common"
        )
    values = {
        channel: (_at(own, channel, t[common]), _column(listed, column)[common]) for channel, column in pairs.items()
    }
    sizes: dict[str, float] = {}
    for channel, both in values.items():
        sizes[owner_of(channel)] = max(sizes.get(owner_of(channel), 0.0), *(_size(one) for one in both))
    return tuple(
        _difference(channel, column, *values[channel], t[common], ROUNDING * sizes[owner_of(channel)])
        for channel, column in pairs.items()
    )


def _columns(found: Listed) -> Columns:
    match found:
        case Solution():
            return {**found.channels, TIME: found.time}
        case str() | Path():
            return read_columns(found)
    return {name: np.asarray(values, dtype=float) for name, values in found.items()}


def _at(own: Columns, channel: str, t: np.ndarray) -> np.ndarray:
    """Return a channel at other instants; of two values at one instant, the later one."""
    if channel not in own:
        raise InputError(f"found no channel '{channel}'{did_you_mean(channel, own)}, expected one such as {_some(own)}")
    later = np.append(np.diff(own[TIME]) > 0, True)
    times, values = own[TIME][later], own[channel][later]
    nearest = np.clip(np.searchsorted(times, t), 1, max(len(times) - 1, 1))
    nearest = np.where(np.abs(times[nearest - 1] - t) <= np.abs(times[nearest % len(times)] - t), nearest - 1, nearest)
    if np.allclose(times[nearest], t, rtol=0, atol=ROUNDING * max(abs(times[-1]), times[-1] - times[0])):
        return np.asarray(values[nearest])
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(times, values)(t))


def _column(listed: Columns, text: str) -> np.ndarray:
    """Return a column, times a factor if one is given."""
    name, _, factor = text.rpartition("*") if text not in listed else (text, "", "")
    name, factor = (name, factor) if name else (text, "")
    if name not in listed:
        raise InputError(f"found no column '{name}'{did_you_mean(name, listed)}, expected one of {_some(listed)}")
    try:
        return listed[name] * (float(factor) if factor else 1.0)
    except ValueError:
        raise InputError(f"found '{text}', expected COLUMN or COLUMN*FACTOR") from None


def _size(values: np.ndarray) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))


def _difference(
    channel: str, column: str, own: np.ndarray, listed: np.ndarray, t: np.ndarray, least: float
) -> Difference:
    apart = np.abs(own - listed)
    if not np.isfinite(apart).any():
        return Difference(channel, column, float("nan"), float(t[0]), float("nan"))
    k = int(np.nanargmax(apart))
    size = max(_size(listed) or _size(own), least)
    largest = float(apart[k])
    return Difference(channel, column, largest, float(t[k]), largest / size if size else 0.0)


def _some(columns: Columns) -> str:
    names = [name for name in columns if name != TIME]
    return ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")

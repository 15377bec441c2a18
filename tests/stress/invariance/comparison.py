"""Compare the channels of two runs with their error bars."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stiffmbs.results.scales import scales

from .change import Channels
from .ways import Found

NOT_COMPARED = ("constraint.",)
ACCELERATIONS = ".ax", ".ay", ".az", ".alpha", ".wdx", ".wdy", ".wdz", "acceleration"
ROUNDING = 1e-9
"""Allowed difference in SI units; of accelerations, the one that changes a velocity by as much between two outputs."""


@dataclass(frozen=True)
class Allowance:
    """Allowed difference between channels of two runs.

    Attributes
    ----------
    floor : float
        Allowed difference relative to the size of a channel.
    bars : float
        Allowed difference in error bars: differences of the runs at two tolerances.
    sensitive : float
        Error bar, relative to the size of a channel, above which the channel is not compared.
    """

    floor: float = 2e-5
    bars: float = 20.0
    sensitive: float = 1e-2


ALLOWANCE = Allowance()


@dataclass(frozen=True)
class Difference:
    """Channel with the largest difference between two runs, relative to the allowed one.

    Attributes
    ----------
    ratio : float
    channel : str
    detail : str
    """

    ratio: float
    channel: str
    detail: str


def compared(one: Found, other: Found, bars: Channels, allowance: Allowance = ALLOWANCE) -> Difference:
    """Return the largest difference of two runs.

    Parameters
    ----------
    one, other : Found
        The original, and the transformed run with its channels transformed back.
    bars : dict of str to ndarray
        Differences of runs of different tolerance.
    allowance : Allowance
    """
    sizes = scales(one.channels, 1.0)
    spacing = min(1.0, float(np.diff(one.time).min(initial=1.0)))
    worst = Difference(0.0, "", "no channel is compared")
    common = [name for name in one.channels if name in other.channels and not name.startswith(NOT_COMPARED)]
    for name in common:
        if name in one.not_unique or name in other.not_unique:
            continue
        size, bar = sizes.get(name, 0.0), float(np.max(bars[name]))
        size = max(size, float(np.ptp(one.channels[name])) if name.count(".") == 0 else 0.0)
        allowed = allowance.floor * size + allowance.bars * bar
        if not bar <= allowance.sensitive * max(size, ROUNDING):
            continue
        gap = difference(name, one.channels[name], other.channels[name])
        place = int(np.argmax(gap))
        least = ROUNDING / spacing if name.endswith(ACCELERATIONS) else ROUNDING
        ratio = float(gap[place]) / max(allowed, least)
        if not ratio <= worst.ratio:
            detail = f"{one.channels[name][place]:.9g} and {other.channels[name][place]:.9g} at output {place}, size {size:.2g}, bar {bar:.1e}"
            worst = Difference(ratio, name, detail)
    return worst


def bars_of(one: Found, other: Found) -> Channels:
    """Return the differences of two runs of one scene."""
    return {name: difference(name, series, other.channels[name]) for name, series in one.channels.items()}


def difference(name: str, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the difference of two channels; angles modulo whole turns, potential energy up to a constant."""
    label = name.rpartition(".")[2]
    gap = one - other
    if name in ("energy.potential", "energy.total"):
        gap = gap - gap[0]
    if label == "angle":
        gap = np.angle(np.exp(1j * gap))
    if label in ("q0", "q1", "q2", "q3"):
        return np.minimum(np.abs(gap), np.abs(one + other))
    return np.asarray(np.abs(gap))

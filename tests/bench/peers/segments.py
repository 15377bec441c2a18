"""Time from breakpoint to breakpoint, where a user starts an integrator anew."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np


def segments_of(times: np.ndarray, breakpoints: tuple[float, ...]) -> Iterator[tuple[np.ndarray, int]]:
    """For each segment its times, ends included, and how many of them are output times after its begin."""
    begun = times[0]
    for end in (*breakpoints, times[-1]):
        inside = times[(times > begun) & (times <= end)]
        beyond = [] if len(inside) and inside[-1] == end else [end]
        yield np.concatenate([[begun], inside, beyond]), len(inside)
        begun = end

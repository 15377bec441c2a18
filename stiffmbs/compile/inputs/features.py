"""Features of inputs in time: breakpoints, and step limits that resolve the other features.

Step control extrapolates: after a rest, steps would miss a pulse. Before a run, each input is therefore divided into
pieces that a cubic represents, by ranges of its Taylor coefficients (Moore, Kearfott, Cloud, 2009, chapter 9). No
feature hides between samples. A step is limited to a few lengths of the pieces that it touches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from ..system import System
from .breakpoints import breakpoint_times
from .of_time import Input, inputs_of
from .pieces import Bounds, InputPieces

PIECES_OF_A_STEP = 7.0
"""Longest step in piece lengths: half a period of a sine."""
ALIKE = 2.0
"""Ratio within which bounds of neighbouring pieces are merged to the smaller one."""


@dataclass(frozen=True)
class InputFeatures:
    """Features of all inputs between two times.

    Attributes
    ----------
    breakpoints : ndarray
        Times to stop and restart at, s.
    starts, longest : ndarrays
        Start of each interval and longest step that may touch it, s; empty if nothing limits steps.
    note : str
        Note for the user, or ''.
    """

    breakpoints: np.ndarray = field(default_factory=lambda: np.empty(0))
    starts: np.ndarray = field(default_factory=lambda: np.empty(0))
    longest: np.ndarray = field(default_factory=lambda: np.empty(0))
    note: str = ""

    @cached_property
    def ends(self) -> np.ndarray:
        """End of each interval."""
        return np.append(self.starts[1:], np.inf)

    def longest_step(self, t: float) -> float:
        """Return the longest step from a given time, s (as `stiffmbs.solve.native.longest_step`)."""
        if not len(self.starts):
            return np.inf
        k = max(int(np.searchsorted(self.starts, t, side="right")) - 1, 0)
        h = float(self.longest[k])
        while k + 1 < len(self.starts) and self.starts[k + 1] < t + h:
            k += 1
            h = min(h, max(float(self.longest[k]), float(self.starts[k]) - t))
        return h

    def within(self, start: float, end: float) -> InputFeatures:
        """Return the features between two times."""
        if not len(self.starts) and not len(self.breakpoints):
            return self
        inside = (self.starts < end) & (self.ends > start)
        breakpoints = self.breakpoints[(self.breakpoints > start) & (self.breakpoints < end)]
        return InputFeatures(breakpoints, self.starts[inside], self.longest[inside], self.note)

    def narrowest(self) -> tuple[float, float]:
        """Return length and start of the narrowest feature, s; infinite length if there is none."""
        found = [(np.inf, 0.0)]
        if len(self.breakpoints) > 1:
            gaps = np.diff(self.breakpoints)
            found.append((float(np.min(gaps)), float(self.breakpoints[np.argmin(gaps)])))
        if len(self.longest):
            k = int(np.argmin(self.longest))
            found.append((float(self.longest[k]), float(self.starts[k])))
        return min(found)

    def instants(self, start: float, end: float, spacing: float, most: int) -> np.ndarray:
        """Return at most `most` times that resolve features narrower than a spacing, a few within each."""
        narrow = np.isfinite(self.longest) & (self.longest < spacing)
        begin, until = np.maximum(self.starts[narrow], start), np.minimum(self.ends[narrow], end)
        count = np.ceil((until - begin) / self.longest[narrow] * INSTANTS).astype(np.int64)
        if np.sum(count) > most:
            count = np.maximum(count * most // np.sum(count), 1)
        parts = [np.linspace(a, b, n + 1) for a, b, n in zip(begin, until, count, strict=True) if b > a]
        gaps = np.concatenate([[start], self.breakpoints, [end]])
        close = np.flatnonzero(np.diff(gaps) < spacing)[: most // INSTANTS]
        between = gaps[close, None] + np.diff(gaps)[close, None] * np.linspace(0, 1, INSTANTS + 1)
        return np.unique(np.concatenate([*parts, between.ravel()]))


INSTANTS = 8
"""Times that resolve a narrow feature."""
NO_FEATURES = InputFeatures()
"""Features of a system without formulas and tables of time."""


def input_features(system: System, start: float, end: float) -> InputFeatures:
    """Return the features of a system's inputs between two times.

    Raises
    ------
    InputError
        If an input has too many breakpoints.
    """
    return _features(tuple(inputs_of(system)), start, end)


@lru_cache
def _features(inputs: tuple[Input, ...], start: float, end: float) -> InputFeatures:
    breakpoints = breakpoint_times(inputs, start, end)
    pieces = [InputPieces(each, np.concatenate([[start], breakpoints, [end]])) for each in inputs]
    bounds = [each.bounds() for each in pieces]
    estimated = [given.text for given, each in zip(inputs, pieces, strict=True) if each.estimated]
    note = (
        f"'{estimated[0]}' has too many features to be listed: steps follow from a sample of them" if estimated else ""
    )
    return InputFeatures(breakpoints, *_together(bounds, breakpoints, start, end), note)


def _together(
    bounds: Sequence[Bounds], breakpoints: np.ndarray, start: float, end: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest of all step limits; empty if none is shorter than the time between breakpoints."""
    starts = np.unique(np.concatenate([[start], breakpoints, *(each.starts for each in bounds)]))
    longest = np.full(len(starts), np.inf)
    for each in bounds:
        k = np.searchsorted(each.starts, starts, side="right") - 1
        longest = np.fmin(longest, np.where(k >= 0, PIECES_OF_A_STEP * each.lengths[k], np.inf))
    ends_of_segments = np.concatenate([[start], breakpoints, [end]])
    segment = np.clip(np.searchsorted(ends_of_segments, starts, side="right") - 1, 0, len(ends_of_segments) - 2)
    longest = np.where(longest < np.diff(ends_of_segments)[segment], longest, np.inf)
    if not np.isfinite(longest).any():
        return np.empty(0), np.empty(0)
    return _merged(starts, longest)


def _merged(starts: np.ndarray, longest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Merge neighbours with similar bounds to one interval with the smaller bound."""
    kept_starts, kept = [float(starts[0])], [float(longest[0])]
    least = most = kept[0]
    for t, bound in zip(starts[1:].tolist(), longest[1:].tolist(), strict=True):
        least, most = min(least, bound), max(most, bound)
        if least == most or most <= ALIKE * least:
            kept[-1] = least
        else:
            kept_starts.append(t)
            kept.append(bound)
            least = most = bound
    return np.array(kept_starts), np.array(kept)

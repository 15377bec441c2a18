"""Where in time the inputs of a scene have features: corners to stop at, and the longest step that still sees the rest.

Step control trusts what it has seen: after a rest its steps jump over a pulse.  Before a run, each input is cut into
pieces until a cubic represents it, by ranges of its Taylor coefficients (Moore, Kearfott, Cloud, 2009, chapter 9), so
that no feature hides between samples.  A step may not be longer than a few of the pieces that it touches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .corners import corner_times
from .inputs_of_time import Input, inputs_of
from .system import System

PIECES_OF_A_STEP = 7.0
"""Lengths of a piece that a step may have: half a turn of a sine."""
PART = 3e-3
"""Error of the cubic, in parts of the input's change around the piece."""
LEAST_PART = 1e-4
"""That change counts at least as so much of the input's change in the whole run."""
ROUNDING = 1e-10
"""Error of the cubic, in parts of the input's values, that is always allowed."""
SHORTEST = 1e-11
"""Length of a piece, in parts of the times themselves, that is cut no further."""
MOST_PIECES, MANY_PIECES = 2**13, 512
"""Pieces of one input that are cut further: from there on only those that need it most are; and so many that it is
worth to see whether they need be so many."""
ROUNDING_OF_PARTS, ROUNDING_OF_SAMPLES = 1e-15, 100.0
"""Rounding of what the first ranges of an input hold, in parts of it; by so many times more samples may differ."""
SAMPLE, QUANTILE = 64, 0.1
"""Pieces whose bounds stand for those of all others where they are too many, and which of theirs does."""
URGENT = 64
"""So many times longer than its bound a piece is to be cut beyond that number."""
ALIKE = 2.0
"""Factor within which bounds of neighbouring pieces are taken for the same, the smaller one."""
WINDOW = np.array([-0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25])
"""Where the change around a piece is looked at, in lengths from its start."""


@dataclass(frozen=True)
class InputFeatures:
    """The features of all inputs between two times.

    Attributes
    ----------
    corners : ndarray
        Instants to stop and start anew at, s.
    starts, longest : ndarrays
        From each of these times on, up to the next: the longest step that may touch it, s; empty where nothing bounds
        a step.
    """

    corners: np.ndarray = field(default_factory=lambda: np.empty(0))
    starts: np.ndarray = field(default_factory=lambda: np.empty(0))
    longest: np.ndarray = field(default_factory=lambda: np.empty(0))

    @cached_property
    def ends(self) -> np.ndarray:
        """The end of each stretch."""
        return np.append(self.starts[1:], np.inf)

    def longest_step(self, t: float) -> float:
        """The longest step from a time on, s (as `stiffmbs.solve.native.longest_step`)."""
        if not len(self.starts):
            return np.inf
        k = max(int(np.searchsorted(self.starts, t, side="right")) - 1, 0)
        h = float(self.longest[k])
        while k + 1 < len(self.starts) and self.starts[k + 1] < t + h:
            k += 1
            h = min(h, max(float(self.longest[k]), float(self.starts[k]) - t))
        return h

    def within(self, start: float, end: float) -> InputFeatures:
        """Those between two times."""
        inside = (self.starts < end) & (self.ends > start)
        corners = self.corners[(self.corners > start) & (self.corners < end)]
        return InputFeatures(corners, self.starts[inside], self.longest[inside])

    def narrowest(self) -> tuple[float, float]:
        """The length of the narrowest feature, s, and when it begins; infinite where there is none."""
        found = [(np.inf, 0.0)]
        if len(self.corners) > 1:
            gaps = np.diff(self.corners)
            found.append((float(np.min(gaps)), float(self.corners[np.argmin(gaps)])))
        if len(self.longest):
            k = int(np.argmin(self.longest))
            found.append((float(self.longest[k]), float(self.starts[k])))
        return min(found)

    def instants(self, start: float, end: float, spacing: float, most: int) -> np.ndarray:
        """Instants that show the features narrower than a spacing: a few within each, at most so many."""
        narrow = np.isfinite(self.longest) & (self.longest < spacing)
        begin, until = np.maximum(self.starts[narrow], start), np.minimum(self.ends[narrow], end)
        count = np.ceil((until - begin) / self.longest[narrow] * INSTANTS).astype(np.int64)
        if np.sum(count) > most:
            count = np.maximum(count * most // np.sum(count), 1)
        parts = [np.linspace(a, b, n + 1) for a, b, n in zip(begin, until, count, strict=True) if b > a]
        gaps = np.concatenate([[start], self.corners, [end]])
        close = np.flatnonzero(np.diff(gaps) < spacing)[: most // INSTANTS]
        between = gaps[close, None] + np.diff(gaps)[close, None] * np.linspace(0, 1, INSTANTS + 1)
        return np.unique(np.concatenate([*parts, between.ravel()]))


INSTANTS = 8
"""Instants that show a narrow feature."""


def input_features(system: System, start: float, end: float) -> InputFeatures:
    """The features of a system's inputs between two times.

    Raises
    ------
    InputError
        When an input has too many corners.
    """
    inputs = inputs_of(system)
    corners = corner_times(inputs, start, end)
    bounds = [_Cut(each, np.concatenate([[start], corners, [end]])).bounds() for each in inputs]
    return InputFeatures(corners, *_together(bounds, corners, start, end))


@dataclass(frozen=True)
class _Bounds:
    """Lengths of pieces: from each time to the next, the longest piece there that a cubic represents."""

    starts: np.ndarray
    lengths: np.ndarray


@dataclass(frozen=True)
class _Pieces:
    """Pieces that are looked at together, and how much the input changes around each."""

    low: np.ndarray
    high: np.ndarray
    change: np.ndarray

    @property
    def length(self) -> np.ndarray:
        return self.high - self.low

    def where(self, which: np.ndarray) -> _Pieces:
        return _Pieces(self.low[which], self.high[which], self.change[which])

    def halved(self) -> _Pieces:
        middle = (self.low + self.high) / 2
        return _Pieces(
            np.concatenate([self.low, middle]), np.concatenate([middle, self.high]), np.tile(self.change / 2, 2)
        )


class _Cut:
    """One input, cut until a cubic represents each piece.

    Attributes
    ----------
    change, size : float
        Of the input in the whole run, as far as it was seen: how much it changes, and its largest value.
    estimated : bool
        Whether pieces were too many, and the bounds of some are those of others.
    """

    def __init__(self, given: Input, edges: np.ndarray) -> None:
        self._given, self._edges = given, edges
        self._shortest = SHORTEST * max(abs(edges[0]), abs(edges[-1]))
        self._least, self._greatest = np.inf, -np.inf
        self._rounding = 0.0
        self.change, self.size, self.estimated = 0.0, 0.0, False

    def bounds(self) -> _Bounds:
        """The pieces; cut again where the first of them were cut for a change that was seen too small."""
        whole = _Pieces(self._edges[:-1], self._edges[1:], np.zeros(len(self._edges) - 1))
        with np.errstate(all="ignore"):
            found = self._cut(whole, first=True)
            if len(found.starts) > MANY_PIECES:
                found = self._cut(whole, first=True)
        order = np.argsort(found.starts)
        return _Bounds(found.starts[order], found.lengths[order])

    def _cut(self, pieces: _Pieces, first: bool) -> _Bounds:
        done: list[tuple[np.ndarray, np.ndarray]] = []
        while len(pieces.low):
            pieces = self._looked_at(pieces)
            h, lengths = pieces.length, self._longest(pieces)
            settled = (lengths >= h) | (h <= self._shortest)
            if not first:
                lengths = np.minimum(lengths, 2 * h)  # as the piece twice as long was too long
            first = False
            if np.count_nonzero(~settled) > MOST_PIECES:
                settled |= h < URGENT * lengths
            if np.count_nonzero(~settled) > MOST_PIECES:
                lengths = self._estimated(pieces, lengths, ~settled)
                settled[:] = True
            done.append((pieces.low[settled], np.maximum(lengths[settled], self._shortest)))
            pieces = pieces.where(~settled).halved()
        starts, lengths = (np.concatenate(parts) for parts in zip(*done, strict=True))
        return _Bounds(starts, lengths)

    def _looked_at(self, pieces: _Pieces) -> _Pieces:
        """The pieces with the change that samples in and around them show."""
        leg = np.searchsorted(self._edges, (pieces.low + pieces.high) / 2) - 1
        t = np.clip(pieces.low + WINDOW[:, None] * pieces.length, self._edges[leg], self._edges[leg + 1])
        seen = self._given.at(t.ravel()).reshape(t.shape)
        seen = np.where(np.isfinite(seen), seen, np.nan)
        least, greatest = np.fmin.reduce(seen), np.fmax.reduce(seen)
        self._least = min(self._least, np.fmin.reduce(least, initial=np.inf))
        self._greatest = max(self._greatest, np.fmax.reduce(greatest, initial=-np.inf))
        if self._greatest >= self._least:
            self.change, self.size = self._greatest - self._least, max(abs(self._least), abs(self._greatest))
        return _Pieces(pieces.low, pieces.high, np.fmax(greatest - least, pieces.change))

    def _longest(self, pieces: _Pieces) -> np.ndarray:
        """The longest part of each piece that a polynomial up to the third degree represents.

        About the middle of a part of length h its error is at most (h/2)^k / 2 times the width of the range of the k-th
        Taylor coefficient.  Ends are left out by a rounding, so that a corner there does not count.
        """
        inner = np.minimum(self._shortest / 4, pieces.length / 4)
        found = self._given.within(pieces.low + inner, pieces.high - inner, order=3)
        if not self._rounding:
            largest = np.abs(found.value[np.isfinite(found.value)]).max(initial=0.0)
            self._rounding = max(ROUNDING_OF_PARTS * largest, np.finfo(float).tiny)
        allowed = np.maximum(PART * np.maximum(pieces.change, LEAST_PART * self.change), ROUNDING * self.size)
        allowed = np.maximum(allowed, self._rounding)
        lengths = np.where(_width(found[0]) <= 2 * allowed, np.inf, 0.0)
        for k in (1, 2, 3):
            lengths = np.fmax(lengths, 2 * (2 * allowed / _width(found[k])) ** (1 / k))
        return np.where(np.isnan(found.value).any(axis=0), np.inf, lengths)

    def _estimated(self, pieces: _Pieces, lengths: np.ndarray, open_ones: np.ndarray) -> np.ndarray:
        """Bounds where pieces are too many to be cut further: those of a few of them; none where samples show nothing."""
        self.estimated = True
        still = pieces.change <= ROUNDING_OF_SAMPLES * self._rounding
        chosen = np.flatnonzero(open_ones & ~still)
        lengths = np.where(open_ones & still, np.inf, lengths)
        if len(chosen):
            sample = np.zeros_like(open_ones)
            sample[chosen[:: max(1, len(chosen) // SAMPLE)]] = True
            of_some = self._cut(pieces.where(sample), first=False).lengths
            lengths[chosen] = np.maximum(lengths[chosen], np.quantile(of_some, QUANTILE))
        return lengths


def _width(x: np.ndarray) -> np.ndarray:
    return np.where(x[1] == x[0], 0.0, x[1] - x[0])


def _together(
    bounds: Sequence[_Bounds], corners: np.ndarray, start: float, end: float
) -> tuple[np.ndarray, np.ndarray]:
    """The least of all bounds on steps; nothing where none is shorter than the time between corners."""
    starts = np.unique(np.concatenate([[start], corners, *(each.starts for each in bounds)]))
    longest = np.full(len(starts), np.inf)
    for each in bounds:
        k = np.searchsorted(each.starts, starts, side="right") - 1
        longest = np.fmin(longest, np.where(k >= 0, PIECES_OF_A_STEP * each.lengths[k], np.inf))
    ends_of_legs = np.concatenate([[start], corners, [end]])
    leg = np.clip(np.searchsorted(ends_of_legs, starts, side="right") - 1, 0, len(ends_of_legs) - 2)
    longest = np.where(longest < np.diff(ends_of_legs)[leg], longest, np.inf)
    if not np.isfinite(longest).any():
        return np.empty(0), np.empty(0)
    return _merged(starts, longest)


def _merged(starts: np.ndarray, longest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Neighbours with bounds that are alike as one stretch with the smaller bound."""
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

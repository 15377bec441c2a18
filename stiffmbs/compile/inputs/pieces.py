"""Subdivision of an input over time into pieces that a cubic represents, by ranges of its Taylor coefficients."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .interval_arithmetic import ROUNDING, Enclosure
from .of_time import Input

OF_CHANGE = 3e-3
"""Allowed error of the cubic, relative to the input's change around the piece."""
LEAST_PART = 1e-4
"""Lower bound of that change, relative to the input's change in the whole run."""
ALWAYS_ALLOWED = 1e-10
"""Error of the cubic that is always allowed, relative to the input's values."""
SHORTEST_PIECE = 1e-11
"""Length, relative to the times, of a piece that is not subdivided further."""
MOST_PIECES, MANY_PIECES = 2**13, 512
"""Number of open pieces above which only urgent ones are subdivided, and of pieces that need a second pass."""
ROUNDING_OF_SAMPLES = 100.0
"""Difference of samples, in roundings of the first ranges of an input, up to which it is constant."""
SAMPLE, QUANTILE = 64, 0.1
"""Size of the sample of pieces used for all others if they are too many, and quantile of its bounds."""
URGENT = 64
"""Ratio of length to bound above which a piece is subdivided beyond that number."""
WINDOW = np.array([-0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25])
"""Sampling points for the change around a piece, in lengths from its start."""


class Bounds(NamedTuple):
    """Bounds on lengths: from each time to the next, the longest piece that a cubic represents."""

    starts: np.ndarray
    lengths: np.ndarray


class _Pieces(NamedTuple):
    """Pieces processed together, and the change of the input around each."""

    low: np.ndarray
    high: np.ndarray
    change: np.ndarray

    @property
    def length(self) -> np.ndarray:
        """Length of each piece, s."""
        return self.high - self.low

    def where(self, which: np.ndarray) -> _Pieces:
        """Return the selected pieces."""
        return _Pieces(self.low[which], self.high[which], self.change[which])

    def halved(self) -> _Pieces:
        """Return the first halves of the pieces, then the second halves."""
        middle = (self.low + self.high) / 2
        return _Pieces(
            np.concatenate([self.low, middle]), np.concatenate([middle, self.high]), np.tile(self.change / 2, 2)
        )


class InputPieces:
    """Subdivision of one input into pieces that a cubic represents.

    `change`, `size`: range and largest absolute value of the input in the run, as sampled. `estimated`: true if there
    were too many pieces, and bounds of some were used for others.
    """

    def __init__(self, given: Input, edges: np.ndarray) -> None:
        self._given, self._edges = given, edges
        self._shortest = SHORTEST_PIECE * max(abs(edges[0]), abs(edges[-1]))
        self._least, self._greatest = np.inf, -np.inf
        self._rounding = 0.0
        self.change, self.size, self.estimated = 0.0, 0.0, False

    def bounds(self) -> Bounds:
        """Return the pieces; many pieces are computed again with the input's change in the whole run."""
        whole = _Pieces(self._edges[:-1], self._edges[1:], np.zeros(len(self._edges) - 1))
        with np.errstate(all="ignore"):
            found = self._cut(whole, first=True)
            if len(found.starts) > MANY_PIECES:
                found = self._cut(whole, first=True)
        order = np.argsort(found.starts)
        return Bounds(found.starts[order], found.lengths[order])

    def _cut(self, pieces: _Pieces, first: bool) -> Bounds:
        done: list[tuple[np.ndarray, np.ndarray]] = []
        while len(pieces.low):
            pieces = self._looked_at(pieces)
            h, lengths = pieces.length, self._longest(pieces)
            settled = (lengths >= h) | (h <= self._shortest)
            if not first:
                lengths = np.minimum(lengths, 2 * h)  # the parent piece was too long
            first = False
            if np.count_nonzero(~settled) > MOST_PIECES:
                settled |= h < URGENT * lengths
            if np.count_nonzero(~settled) > MOST_PIECES:
                lengths = self._estimated(pieces, lengths, ~settled)
                settled[:] = True
            done.append((pieces.low[settled], np.maximum(lengths[settled], self._shortest)))
            pieces = pieces.where(~settled).halved()
        starts, lengths = (np.concatenate(parts) for parts in zip(*done, strict=True))
        return Bounds(starts, lengths)

    def _looked_at(self, pieces: _Pieces) -> _Pieces:
        """Return the pieces with the change seen by samples in and around them."""
        segment = np.searchsorted(self._edges, (pieces.low + pieces.high) / 2) - 1
        t = np.clip(pieces.low + WINDOW[:, None] * pieces.length, self._edges[segment], self._edges[segment + 1])
        seen = self._given.at(t.ravel()).reshape(t.shape)
        seen = np.where(np.isfinite(seen), seen, np.nan)
        least, greatest = np.fmin.reduce(seen), np.fmax.reduce(seen)
        self._least = min(self._least, np.fmin.reduce(least, initial=np.inf))
        self._greatest = max(self._greatest, np.fmax.reduce(greatest, initial=-np.inf))
        if self._greatest >= self._least:
            self.change, self.size = self._greatest - self._least, max(abs(self._least), abs(self._greatest))
        return _Pieces(pieces.low, pieces.high, np.fmax(greatest - least, pieces.change))

    def _longest(self, pieces: _Pieces) -> np.ndarray:
        """Return the longest part of each piece that a polynomial of degree three or less represents.

        About the middle of a part of length h the error is at most (h/2)^k / 2 times the width of the range of the k-th
        Taylor coefficient. Piece ends are excluded by a rounding, so that breakpoints there do not count.
        """
        inner = np.minimum(self._shortest / 4, pieces.length / 4)
        found = self._given.within(pieces.low + inner, pieces.high - inner, order=3)
        if not self._rounding:
            largest = np.abs(found.value[np.isfinite(found.value)]).max(initial=0.0)
            self._rounding = max(ROUNDING * largest, np.finfo(float).tiny)
        lengths = longest_pieces(found, pieces.change, self.change, self.size, self._rounding)
        return np.where(np.isnan(found.value).any(axis=0), np.inf, lengths)

    def _estimated(self, pieces: _Pieces, lengths: np.ndarray, open_ones: np.ndarray) -> np.ndarray:
        """Return bounds from a sample of pieces, too many to subdivide; infinite where the input is constant."""
        still = pieces.change <= ROUNDING_OF_SAMPLES * self._rounding
        chosen = np.flatnonzero(open_ones & ~still)
        lengths = np.where(open_ones & still, np.inf, lengths)
        if len(chosen):
            self.estimated = True
            sample = np.zeros_like(open_ones)
            sample[chosen[:: max(1, len(chosen) // SAMPLE)]] = True
            of_some = self._cut(pieces.where(sample), first=False).lengths
            lengths[chosen] = np.maximum(lengths[chosen], np.quantile(of_some, QUANTILE))
        return lengths


def longest_pieces(
    found: Enclosure, change: np.ndarray, whole: float, size: float, rounding: float = 0.0
) -> np.ndarray:
    """Return the longest parts of pieces that a cubic represents.

    `found`: ranges of the input over the pieces. `change`, `whole`: its change around each piece, and in the whole run.
    `size`: its largest absolute value. `rounding`: that of its ranges.
    """
    allowed = np.maximum(OF_CHANGE * np.maximum(change, LEAST_PART * whole), max(ALWAYS_ALLOWED * size, rounding))
    lengths = np.where(_width(found[0]) <= 2 * allowed, np.inf, 0.0)
    for k in (1, 2, 3):
        lengths = np.fmax(lengths, 2 * (2 * allowed / _width(found[k])) ** (1 / k))
    return lengths


def _width(x: np.ndarray) -> np.ndarray:
    return np.where(x[1] == x[0], 0.0, x[1] - x[0])

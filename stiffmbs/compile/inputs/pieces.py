"""One input over time, cut into pieces until a cubic represents each of them, by ranges of its Taylor coefficients."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .of_time import Input

OF_CHANGE = 3e-3
"""Error of the cubic, relative to the input's change around the piece."""
LEAST_PART = 1e-4
"""That change counts at least as so much of the input's change in the whole run."""
ALWAYS_ALLOWED = 1e-10
"""Error of the cubic, relative to the input's values, that is always allowed."""
SHORTEST_PIECE = 1e-11
"""Length of a piece, relative to the times themselves, that is cut no further."""
MOST_PIECES, MANY_PIECES = 2**13, 512
"""Pieces of one input that are cut further: from there on only those that need it most are; and so many that it is
worth to see whether they need be so many."""
ROUNDING_OF_PARTS, ROUNDING_OF_SAMPLES = 1e-15, 100.0
"""Rounding of what the first ranges of an input hold, relative to it; by so many times more samples may differ."""
SAMPLE, QUANTILE = 64, 0.1
"""Pieces whose bounds stand for those of all others where they are too many, and which of theirs does."""
URGENT = 64
"""So many times longer than its bound a piece is to be cut beyond that number."""
WINDOW = np.array([-0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25])
"""Where the change around a piece is looked at, in lengths from its start."""


class Bounds(NamedTuple):
    """Lengths of pieces: from each time to the next, the longest piece there that a cubic represents."""

    starts: np.ndarray
    lengths: np.ndarray


class _Pieces(NamedTuple):
    """Pieces that are looked at together, and how much the input changes around each."""

    low: np.ndarray
    high: np.ndarray
    change: np.ndarray

    @property
    def length(self) -> np.ndarray:
        """The length of each, s."""
        return self.high - self.low

    def where(self, which: np.ndarray) -> _Pieces:
        """Those that are chosen."""
        return _Pieces(self.low[which], self.high[which], self.change[which])

    def halved(self) -> _Pieces:
        """Twice as many of half the length: the first halves, then the second ones."""
        middle = (self.low + self.high) / 2
        return _Pieces(
            np.concatenate([self.low, middle]), np.concatenate([middle, self.high]), np.tile(self.change / 2, 2)
        )


class InputPieces:
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
        self._shortest = SHORTEST_PIECE * max(abs(edges[0]), abs(edges[-1]))
        self._least, self._greatest = np.inf, -np.inf
        self._rounding = 0.0
        self.change, self.size, self.estimated = 0.0, 0.0, False

    def bounds(self) -> Bounds:
        """The pieces; cut again where the first of them were cut for a change that was seen too small."""
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
        return Bounds(starts, lengths)

    def _looked_at(self, pieces: _Pieces) -> _Pieces:
        """The pieces with the change that samples in and around them show."""
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
        """The longest part of each piece that a polynomial up to the third degree represents.

        About the middle of a part of length h its error is at most (h/2)^k / 2 times the width of the range of the k-th
        Taylor coefficient.  Ends are left out by a rounding, so that a breakpoint there does not count.
        """
        inner = np.minimum(self._shortest / 4, pieces.length / 4)
        found = self._given.within(pieces.low + inner, pieces.high - inner, order=3)
        if not self._rounding:
            largest = np.abs(found.value[np.isfinite(found.value)]).max(initial=0.0)
            self._rounding = max(ROUNDING_OF_PARTS * largest, np.finfo(float).tiny)
        allowed = np.maximum(
            OF_CHANGE * np.maximum(pieces.change, LEAST_PART * self.change), ALWAYS_ALLOWED * self.size
        )
        allowed = np.maximum(allowed, self._rounding)
        lengths = np.where(_width(found[0]) <= 2 * allowed, np.inf, 0.0)
        for k in (1, 2, 3):
            lengths = np.fmax(lengths, 2 * (2 * allowed / _width(found[k])) ** (1 / k))
        return np.where(np.isnan(found.value).any(axis=0), np.inf, lengths)

    def _estimated(self, pieces: _Pieces, lengths: np.ndarray, open_ones: np.ndarray) -> np.ndarray:
        """Bounds where pieces are too many to be cut further: those of a few of them; none where samples show nothing."""
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


def _width(x: np.ndarray) -> np.ndarray:
    return np.where(x[1] == x[0], 0.0, x[1] - x[0])

"""Features of inputs in time: breakpoints, and step limits that resolve the other features.

Step control extrapolates: after a rest, steps would miss a pulse. Before a run, each input is therefore divided into
pieces that a cubic represents, by ranges of its Taylor coefficients (Moore, Kearfott, Cloud, 2009, chapter 9). No
feature hides between samples. A step is limited to a few lengths of the pieces that it touches.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError
from ...reading.formula.functions import EACH, IN_FORMULAS, Breakpoints
from ...reading.formula.nodes import TIME, reading_order
from ..system import System
from .distinct import distinct
from .interval_arithmetic import ROUNDING
from .of_time import Input, inputs_of
from .pieces import Bounds, InputPieces
from .zeros import FIRST_STRETCHES, SHORTEST_STRETCH, ZERO, TooMany, zeros

if TYPE_CHECKING:
    from .calm import RangedInput

PIECES_OF_A_STEP = 7.0
"""Longest step in piece lengths: half a period of a sine."""
ALIKE = 2.0
"""Ratio within which bounds of neighbouring pieces are merged to the smaller one."""


@dataclass(frozen=True, eq=False)
class InputFeatures:
    """Features of all inputs between two times.

    `breakpoints`: times to stop and restart at in increasing order, s. `starts`, `longest`: start of each interval and longest step that
    may touch it, s; empty if nothing limits steps. `note`: note for the user, or ''. `at_ends`: breakpoints at the
    first and the last time, s. `bends`: other times at which the curvature of a force's table jumps, s.
    """

    breakpoints: np.ndarray = field(default_factory=lambda: np.empty(0))
    starts: np.ndarray = field(default_factory=lambda: np.empty(0))
    longest: np.ndarray = field(default_factory=lambda: np.empty(0))
    note: str = ""
    at_ends: np.ndarray = field(default_factory=lambda: np.empty(0))
    bends: np.ndarray = field(default_factory=lambda: np.empty(0))

    @cached_property
    def all_breakpoints(self) -> np.ndarray:
        """Breakpoints within and at both ends, s."""
        return distinct(self.breakpoints, self.at_ends) if len(self.at_ends) else self.breakpoints

    @cached_property
    def ends(self) -> np.ndarray:
        """End of each interval."""
        return np.append(self.starts[1:], np.inf)

    def longest_step(self, t: float) -> float:
        """Return the longest step from a given time, s (as `stiffmbs.solve.events.native.step_bound.longest_step`)."""
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
        if not any(map(len, (self.starts, self.breakpoints, self.at_ends, self.bends))):
            return self
        inside = (self.starts < end) & (self.ends > start)
        within, at_ends = _parted(self.all_breakpoints, start, end)
        bends = self.bends[(self.bends > start) & (self.bends < end)]
        return InputFeatures(within, self.starts[inside], self.longest[inside], self.note, at_ends, bends)

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
        return distinct(*parts, between)


INSTANTS = 8
"""Times that resolve a narrow feature, or an input between two output times."""
NO_FEATURES = InputFeatures()
"""Features of a system without formulas and tables of time."""


def input_features(system: System, start: float, end: float) -> InputFeatures:
    """Return the features of a system's inputs between two times.

    Raises InputError if an input has too many breakpoints.
    """
    return _features(tuple(inputs_of(system)), start, end)


@lru_cache
def _features(inputs: tuple[Input, ...], start: float, end: float) -> InputFeatures:
    breakpoints, at_ends = _parted(breakpoints_from(inputs, start, end), start, end)
    pieces = [InputPieces(each, np.concatenate([[start], breakpoints, [end]])) for each in inputs]
    bounds = [each.bounds() for each in pieces]
    estimated = [given.text for given, each in zip(inputs, pieces, strict=True) if each.estimated]
    note = (
        f"'{estimated[0]}' has too many features to be listed: steps follow from a sample of them" if estimated else ""
    )
    bends = _bends(inputs, distinct(breakpoints, at_ends), start, end)
    return InputFeatures(breakpoints, *_together(bounds, breakpoints, start, end), note, at_ends, bends)


def _bends(inputs: Sequence[Input], breakpoints: np.ndarray, start: float, end: float) -> np.ndarray:
    """Return the times within a run at which the curvature of an input's table jumps, without the breakpoints.

    An input with too many of them has none.
    """
    found: list[np.ndarray] = []
    for each in inputs:
        if each.tables and not each.of_joint:
            with suppress(TooMany):
                found += list(_passages(replace(each, of_joint=True), start, end))
    if not found:
        return np.empty(0)
    times = distinct(*found, breakpoints)
    times = _parted(times[np.diff(times, prepend=-np.inf) > 2.0 * aside(start, end)], start, end)[0]
    return times[~np.isin(times, breakpoints)]


def aside(start: float, end: float) -> float:
    """Return the distance from a breakpoint at which formulas surely have one of its sides, s, in a run between two times."""
    return ROUNDING * max(abs(start), abs(end))


def _parted(times: np.ndarray, start: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the breakpoints within a run, and those at its ends up to rounding."""
    near = 2.0 * aside(start, end)
    times = times[(times >= start - near) & (times <= end + near)]
    within = (times > start + near) & (times < end - near)
    return times[within], times[~within]


def _together(
    bounds: Sequence[Bounds], breakpoints: np.ndarray, start: float, end: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest of all step limits; empty if none is shorter than the time between breakpoints."""
    starts = np.array(sorted({start, *breakpoints.tolist(), *(t for each in bounds for t in each.starts.tolist())}))
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


def breakpoint_times(inputs: Sequence[Input], start: float, end: float) -> np.ndarray:
    """Return the breakpoints in time of some inputs, strictly between start and end, in ascending order; errors as for `breakpoints_from`."""
    times = breakpoints_from(inputs, start, end)
    return times[(times > start) & (times < end)]


def breakpoints_from(inputs: Sequence[Input], start: float, end: float) -> np.ndarray:
    """Return the breakpoints in time of some inputs from start to end, both included, in ascending order.

    `start`, `end`: s.
    """
    found = [np.empty(0)]
    for each in inputs:
        try:
            found += _passages(each, start, end)
        except TooMany as error:
            raise InputError(f"'{each.text}': {error}") from None
    times = np.concatenate(found)
    times = np.sort(times[(times >= start) & (times <= end)])
    apart = SHORTEST_STRETCH * max(abs(start), abs(end), np.finfo(float).tiny)
    return times[np.diff(times, prepend=-np.inf) > apart]


def _passages(given: Input, start: float, end: float) -> Iterator[np.ndarray]:
    seen = set()
    for node in reading_order(given.tree):
        for condition, levels in conditions(given, node, start, end):
            key = ast.dump(condition), levels.tobytes()
            if (
                key in seen
                or not len(levels)
                or not any(isinstance(part, ast.Name) and part.id == TIME for part in ast.walk(condition))
            ):
                continue
            seen.add(key)
            values, ranges = partial(given.at, part=condition), partial(given.within, part=condition)
            yield zeros(values, ranges, start, end, levels)


def conditions(
    given: Input | RangedInput, node: ast.expr, start: float, end: float
) -> Iterator[tuple[ast.expr, np.ndarray]]:
    """Yield expressions and the levels that they cross at the breakpoints of a function or table."""
    match node:
        case ast.Call(ast.Name(name), [argument]) if name in given.tables:
            yield argument, given.tables[name].breakpoints_between(*_range(given, argument, start, end), given.of_joint)
        case ast.Call(ast.Name(name)):
            yield from ((condition, ZERO) for condition in _breakpoints(node, IN_FORMULAS[name].breakpoints))


def _breakpoints(call: ast.Call, breakpoints: Breakpoints) -> Iterator[ast.expr]:
    """Yield the expressions whose zeros are the breakpoints of a function."""
    first, *others = call.args
    if breakpoints == EACH:
        for k, other in enumerate(others):
            before = ast.Call(call.func, [first, *others[:k]], []) if k else first
            yield ast.BinOp(before, ast.Sub(), other)
        return
    for i, j in breakpoints:
        yield call.args[i] if j is None else ast.BinOp(call.args[i], ast.Sub(), call.args[j])


def _range(given: Input | RangedInput, part: ast.expr, start: float, end: float) -> tuple[float, float]:
    edges = np.linspace(start, end, FIRST_STRETCHES + 1)
    with np.errstate(all="ignore"):
        low, high = given.within(edges[:-1], edges[1:], part=part).value
    return float(np.nanmin(low, initial=np.inf)), float(np.nanmax(high, initial=-np.inf))

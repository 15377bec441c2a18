"""Error bars: bounds on the errors of a channel's peaks and of its values over time, from several runs or from estimates.

For a run y0 and more accurate ones y1, y2, ... at the same instants, the error of y0 is y0 - y1 up to the error of y1
(Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, 1993, ch. II.4).  If a better run has at most half
the error of y0, twice the largest difference bounds it.

A difference of two peaks is a single number, and may be small by accident if y1 has the same error as y0.  Let errors
be normally distributed, r times as large in y1 as in y0.  Then twice the difference is too small for 0.42 r of the
peaks, and k times too small for a k-th of these: the ratio has a Cauchy distribution.  So y1 must be much more accurate
than y0, and a further run by another method must agree.  The probability that both share the error of y0 is
proportional to the product.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..dynamics.storage import release
from .scales import ROUNDING, kind_of

Fine = tuple[np.ndarray, np.ndarray, np.ndarray]
SAFETY = 2.0
"""Factor on the difference, valid if a better run has at most half the error."""
NO_RESTARTS = np.empty(0)
FINER = 1.1
"""Factor on the excess at finer instants, as the finest show a little more."""
ARRAYS = 8
"""Arrays of the size of the values that the search of peaks holds."""


@dataclass(frozen=True)
class ErrorBar:
    """Error bounds of one channel, in its own unit; nan if unknown.

    Attributes
    ----------
    over_time : float
        Largest error at an output instant.
    least, greatest : float
        Half widths of the bars of the channel's least and greatest value: error of the solver, and possible excess
        between output instants.
    sampled_least, sampled_greatest : float
        The possible excess alone.
    """

    over_time: float
    least: float
    greatest: float
    sampled_least: float
    sampled_greatest: float


UNKNOWN = ErrorBar(np.nan, np.nan, np.nan, 0.0, 0.0)


@dataclass(frozen=True)
class ErrorEstimate:
    """Outcome of the estimate of the errors of a run.

    - `status`: ``estimated``, ``lost`` (the errors are too large for a linear estimate) or ``none``.
    - `sentence`: for the summary.
    - `largest`: channel with the largest error relative to its size, and `relative`: that error; empty and nan if unknown.
    - `resolved`: least size of motions and velocities to which their errors are relative, m, rad, m/s, rad/s; smaller ones
      are not distinguished from rest.
    - `resolved_force`, `resolved_torque`: forces and torques below them, N, N m, may be rounding of coordinates and have no
      digits; zero if all have.
    - `reached`: the accuracy that was asked for and reached, in words; part of the sentence, too.
    """

    status: str
    sentence: str
    largest: str = ""
    relative: float = float("nan")
    resolved: float = 0.0
    reached: str = ""
    resolved_force: float = 0.0
    resolved_torque: float = 0.0

    def with_accuracy(self, reached: str) -> ErrorEstimate:
        """Return the estimate with what was reached of the accuracy asked for, in words."""
        return replace(self, sentence=f"{self.sentence}; {reached}", reached=reached) if reached else self


RESOLVED = ("resolved", "resolved_force", "resolved_torque")
"""Fields of an estimate below which values are not distinguished from zero."""


def error_bar(values: np.ndarray, others: Sequence[np.ndarray], fine: Fine | None, rounding: float) -> ErrorBar:
    """Return the error bar of one channel.

    `values` of shape (n,): reported values; instants without a value are skipped here and in the other arguments.
    `others` of shapes (m,), m <= n: values of better runs at the same instants, shorter if they ended earlier. `fine`:
    times, s, and values of a run with instants between the reported ones, and the indices of these.
    """
    if not others and fine is None:
        return UNKNOWN
    whole = [float(np.nanmax(np.abs(values - o))) for o in others if len(o) == len(values)]
    over_time = max([0.0, *whole]) if whole or not others else np.nan
    least, sampled_least = _bar_of_maximum(-values, [-o for o in others], fine and (fine[0], -fine[1], fine[2]))
    greatest, sampled_greatest = _bar_of_maximum(values, others, fine)
    return ErrorBar(
        SAFETY * over_time + rounding, least + rounding, greatest + rounding, sampled_least, sampled_greatest
    )


def _bar_of_maximum(values: np.ndarray, others: Sequence[np.ndarray], fine: Fine | None) -> tuple[float, float]:
    """Return the error bar of the greatest value, and the part of it that lies between the instants."""
    at = int(np.nanargmax(values))
    reaching = [other for other in others if len(other) > at]
    if others and not reaching:
        return np.nan, np.nan
    solver = SAFETY * max([0.0, *(abs(values[at] - float(np.nanmax(o))) for o in reaching)])
    sampled = float(between(fine[0], fine[1][None], fine[2])[0]) if fine else 0.0
    return solver + sampled, sampled


def between(times: np.ndarray, values: np.ndarray, at: np.ndarray, restarts: np.ndarray = NO_RESTARTS) -> np.ndarray:
    """Return the excess of a run at many instants over its values at the reported ones, with parabolas at its peaks.

    All peaks between two instants count, as any of them may be the highest. Where values may jump or have a kink, each side
    is continued up to there by its own slope.

    `times` of shape (n,), `values` of shape (channels, n); the result is of shape (channels,). `at`: indices of the reported
    instants. `restarts`: times from which on values belong to the motion after a jump or kink, s.
    """
    return _excess(times, values, np.nanmax(values[:, at], axis=1), restarts)


def _excess(times: np.ndarray, values: np.ndarray, highest: np.ndarray, restarts: np.ndarray) -> np.ndarray:
    """Return the excess of `between` over the `highest` values at the reported instants, shape (channels,)."""
    count = len(values)
    piece = np.searchsorted(restarts, times, side="right")
    ahead = values[:, 1:] >= values[:, :-1]
    peaks = ahead[:, :-1] & (values[:, 1:-1] >= values[:, 2:]) & (piece[:-2] == piece[2:])
    row, k = np.nonzero(peaks)
    k += 1
    here = values[row, k]
    before, after = times[k - 1] - times[k], times[k + 1] - times[k]
    fall, rise = (values[row, k - 1] - here) / before, (values[row, k + 1] - here) / after
    bend = np.minimum((rise - fall) / (after - before), -np.finfo(float).tiny)  # a flat peak has no curvature
    slope = fall - bend * before
    last = np.flatnonzero(np.diff(piece))
    sides = [(last, -1, restarts[piece[last]]), (last + 1, 1, restarts[piece[last + 1] - 1])]
    tops = [slope**2 / (-4 * bend), *(_continued(times, values, piece, *side).ravel() for side in sides)]
    row = np.concatenate([row, *2 * [np.repeat(np.arange(count), len(last))]])
    k, top = np.concatenate([k, np.tile(last, count), np.tile(last + 1, count)]), np.concatenate(tops)
    reached = values[row, k] - highest[row]
    row, k, top, reached = (each[reached + SAFETY * top > 0.0] for each in (row, k, top, reached))
    here = values[row, k]
    around = [np.clip(k + offset, 0, len(times) - 1) for offset in (-2, -1, 1, 2)]
    lowest = np.nanmin([np.where(piece[n] == piece[k], values[row, n], here) for n in around], axis=0)
    top = np.minimum(top, here - lowest)  # limit at jumps
    found = np.maximum(FINER * (np.fmax.reduce(values, axis=1, initial=-np.inf) - highest), 0.0)
    np.fmax.at(found, row, np.where(reached > 0, FINER, 1.0) * reached + SAFETY * top)
    return found


def _continued(
    times: np.ndarray, values: np.ndarray, piece: np.ndarray, k: np.ndarray, inner: int, end: np.ndarray
) -> np.ndarray:
    """Return the excess over the values at k of their continuation to an end, by the slope from their inner neighbours."""
    n = np.clip(k + inner, 0, len(times) - 1)
    alone = (n == k) | (piece[n] != piece[k])
    slope = np.where(alone, 0.0, (values[:, k] - values[:, n]) / np.where(alone, 1.0, times[k] - times[n]))
    return np.maximum(slope * (end - times[k]), 0.0)


@dataclass(frozen=True, eq=False)
class ChannelErrors:
    """Errors of all channels by one mechanism.

    `names` of the channels. `t`, `values`: nodes of the mechanism, s, and the values of the channels there, shape (channels, n).
    `errors`: function for those at some of the output times, shape (channels, n). `restarts`: s.
    """

    names: Sequence[str]
    t: np.ndarray
    values: np.ndarray
    errors: Callable[[slice], np.ndarray]
    restarts: np.ndarray


def bars(
    times: np.ndarray, channels: dict[str, np.ndarray], parts: Sequence[ChannelErrors], numbers_at_once: int
) -> dict[str, ErrorBar]:
    """Return the error bars of the channels of a run from the errors along its mechanisms.

    `numbers_at_once`: numbers in the values of the channels that are examined together.
    """
    names, rows = parts[0].names, max(1, numbers_at_once // (ARRAYS * len(parts[0].names)))
    over_time, at_ends = np.zeros(len(names)), np.full((len(names), 2), np.nan)
    ends, all_names = np.tile([np.inf, -np.inf], (len(names), 1)), np.arange(len(names))  # least and greatest values
    for first in range(0, len(times), rows):
        block = slice(first, min(first + rows, len(times)))
        values = np.array([channels[name][block] for name in names])
        errors = np.abs(np.sum([part.errors(block) for part in parts], axis=0))
        over_time = np.fmax(over_time, np.fmax.reduce(errors, axis=1, initial=0.0))
        for end, sign in enumerate((1.0, -1.0)):
            at = np.where(np.isnan(values), np.inf, sign * values).argmin(axis=1)
            beyond = sign * values[all_names, at] < sign * ends[:, end]
            ends[beyond, end], at_ends[beyond, end] = (each[all_names, at][beyond] for each in (values, errors))
        release(*channels.values())
    sampled = _between_outputs(times, channels, ends, parts, numbers_at_once)
    widths = np.maximum(at_ends, ROUNDING * np.abs(ends)) + sampled  # NaN where the error there is unknown
    numbers = np.column_stack([over_time, np.where(np.isinf(ends), np.nan, widths), sampled]).tolist()
    return {name: ErrorBar(*each) for name, each in zip(names, numbers, strict=True)}


def _between_outputs(
    times: np.ndarray,
    channels: dict[str, np.ndarray],
    ends: np.ndarray,
    parts: Sequence[ChannelErrors],
    numbers_at_once: int,
) -> np.ndarray:
    """Return by how much channels fall below their least value, and exceed their greatest one, between output times.

    `ends`: these values, shape (channels, 2), infinite without values. The result has that shape; NaN is without values.
    """
    names, found = parts[0].names, np.full(ends.shape, np.nan)
    owners = np.argmax([np.ptp(part.values, axis=1) for part in parts], axis=0)  # the mechanism of each channel
    for number, part in enumerate(parts):
        own = np.flatnonzero(np.isfinite(ends).all(axis=1) & (owners == number))
        if len(own):
            values = partial(_with_nodes, times, [channels[names[k]] for k in own.tolist()], part.t, part.values[own])
            at_once = numbers_at_once // (len(own) * (1 + len(part.t) // len(times)))
            found[own] = _both_ends(len(times), values, ends[own], part.restarts, at_once)
    return found


def _with_nodes(
    times: np.ndarray, shown: Sequence[np.ndarray], nodes: np.ndarray, values: np.ndarray, block: slice
) -> tuple[np.ndarray, np.ndarray]:
    """Return some output times with the nodes between them, and the values of channels there, shape (channels, n).

    `shown`: values at all output times. `values`: those at the nodes.
    """
    at = times[block]
    inner = nodes[np.searchsorted(nodes, at[0]) : np.searchsorted(nodes, at[-1], side="right")]
    t = np.sort(np.concatenate([at, inner]))
    t = t[np.diff(t, prepend=-np.inf) > 0.0]
    found = np.array([np.interp(t, nodes, each) for each in values])
    found[:, np.searchsorted(t, at)] = [each[block] for each in shown]
    release(*shown)
    return t, found


def _both_ends(
    count: int, values: Callable[[slice], tuple[np.ndarray, np.ndarray]], limits: np.ndarray, restarts: np.ndarray, at_once: int,
) -> np.ndarray:  # fmt: skip
    """Return the excesses of `between` for the least and the greatest value of channels, `limits`, both of shape (channels, 2).

    `count`: number of reported instants. `values`: function for the times and the values, shape (channels, n), from the first to the
    last of some of these. `at_once`: number of them that are examined together.
    """
    found, rows = np.zeros(limits.shape), 1 + at_once // ARRAYS
    overlap = 3  # a peak at the edge of a block is one within the next, with two instants on either side
    for first in range(0, count, rows):
        t, some = values(slice(max(first - overlap, 0), min(first + rows + overlap, count)))
        for end, sign in enumerate((-1.0, 1.0)):
            found[:, end] = np.maximum(found[:, end], _excess(t, sign * some, sign * limits[:, end], restarts))
    return found


def bars_by_difference(
    times: np.ndarray, at: np.ndarray, channels: Mapping[str, np.ndarray], others: Mapping[str, np.ndarray], part: float,
    restarts: np.ndarray, numbers_at_once: int, close: float = 0.0,
) -> dict[str, ErrorBar]:  # fmt: skip
    """Return the error bars of the channels of a run, from those of a run with another tolerance, at more times.

    A jump between two times of the run is no error if their distance is below the part `close` of that to a next time: the
    other run may be on its other side.

    `at`: places of the times of the run among `times`. `part`: error of the other run in the error of this one, as expected.
    `restarts`: times from which on channels may have jumped, s. `numbers_at_once`: as of `bars`.
    """
    steps = np.diff(times[at])
    errors = {}
    for name, values in channels.items():
        if not name.startswith("constraint."):
            error = np.abs(difference(name, values, others[name][at]))
            errors[name] = np.maximum(error - _jump_beside(values, steps, close), 0.0) / abs(1.0 - part)
    found = dict.fromkeys(errors, UNKNOWN)
    known = [name for name, error in errors.items() if not np.isnan(error).all()]
    if not known:
        return found
    peaks = [(int(np.nanargmin(channels[name])), int(np.nanargmax(channels[name]))) for name in known]
    limits = np.array([channels[name][list(pair)] for name, pair in zip(known, peaks, strict=True)])

    shown, fine = ([of[name] for name in known] for of in (channels, others))
    at_once = numbers_at_once // (len(known) * (1 + len(times) // len(at)))
    sampled = _both_ends(len(at), partial(_with_instants, times, shown, fine, at), limits, restarts, at_once).tolist()
    for name, pair, between_them in zip(known, peaks, sampled, strict=True):
        least, greatest = (float(errors[name][peak]) + excess for peak, excess in zip(pair, between_them, strict=True))
        found[name] = ErrorBar(float(np.nanmax(errors[name])), least, greatest, *between_them)
    return found


def _with_instants(
    times: np.ndarray, shown: Sequence[np.ndarray], fine: Sequence[np.ndarray], at: np.ndarray, block: slice
) -> tuple[np.ndarray, np.ndarray]:
    """Return times from the first to the last of some reported ones, and the values of channels there, shape (channels, n).

    `shown`, `fine`: values at all reported times, and at all times. `at`: places of the reported ones.
    """
    first = at[block.start]
    whole = slice(first, at[block.stop - 1] + 1)
    found = np.array([each[whole] for each in fine])
    found[:, at[block] - first] = [each[block] for each in shown]
    return times[whole], found


def _jump_beside(values: np.ndarray, steps: np.ndarray, part: float) -> np.ndarray:
    """Return the larger jump of a channel in the two steps next to each value, s.

    A jump is the change in a step shorter than a part of a neighbour, as far as the slopes of the neighbours do not explain it.
    """
    change = np.abs(np.diff(values))
    explained = steps * _larger_neighbour(change / steps)
    jump = np.where(steps < part * _larger_neighbour(steps), np.maximum(change - explained, 0.0), 0.0)
    return np.maximum(np.append(jump, 0.0), np.append(0.0, jump))


def _larger_neighbour(values: np.ndarray) -> np.ndarray:
    """Return the larger of the neighbours of each value."""
    return np.maximum(np.append(values[1:], 0.0), np.append(0.0, values[:-1]))


def difference(name: str, values: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return the difference of a channel in two runs; that of an angle is the one of the least turn."""
    return differences([name], values[None], others[None])[0]


def differences(names: Sequence[str], values: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return the differences of channels in two runs, shape (channels, n); as in `difference`."""
    errors = values - others
    angles = [k for k, name in enumerate(names) if kind_of(name) == "angle"]
    errors[angles] -= 2.0 * np.pi * np.round(errors[angles] / (2.0 * np.pi))
    return errors

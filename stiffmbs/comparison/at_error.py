"""Measurements, and run times at equal errors, interpolated between them."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

CLOCK = time.get_clock_info("process_time").resolution
"""Least time of a solution, s, as clocks may show zero."""


@dataclass(frozen=True)
class LineAtError:
    """Choice of the measured points through which a line is laid about a target error.

    `window`: largest ratio of a point's error to the target, either way. `fewest`: least number of points; with fewer
    in the window, the line runs between the two neighbours of the target.
    """

    window: float = 10**1.5
    fewest: int = 4


LINE = LineAtError()


def value_at_error(points: Iterable[tuple[float, float]], target: float) -> float | None:
    """Return the value at an error: on a line through several points on both sides of it, or between two neighbours.

    A point with a smaller error and a smaller value than the line counts with its own value.  Looser settings may take
    longer where stability, not the error, limits steps; they make no solver slower. `points`: errors and values, each
    positive. `target`: error. The result: none if all errors are larger than the target, or there are none.
    """
    own = sorted(points, key=lambda point: point[0])
    if not own or own[0][0] > target:
        return None
    near = [point for point in own if target / LINE.window <= point[0] <= target * LINE.window]
    if len(near) < LINE.fewest or not near[0][0] <= target <= near[-1][0]:
        near = [point for pair in itertools.pairwise(own) if pair[0][0] <= target < pair[1][0] for point in pair]
    values = [value for error, value in own if error <= target]
    if near and near[0][0] <= target <= near[-1][0]:
        values.append(on_line(near, target))
    elif own[-1][0] >= target:
        return None
    return min(values)


def on_line(points: Sequence[tuple[float, float]], target: float) -> float:
    """Return the value at an error, on the straight line through the logarithms of values and errors."""
    errors, values = np.array(points).T
    return float(np.exp(np.polyfit(np.log(errors / target), np.log(values), 1)[-1]))


@dataclass(frozen=True)
class Row:
    """Measurement of a solver configuration at a setting."""

    # solver, setting: texts such as ``dop853`` and ``rtol 1e-06``
    solver: str
    setting: str
    # largest errors over all output instants and channels, by measure; empty if the run failed
    errors: Mapping[str, float]
    seconds: float  # median of the times of a solution; nan if the run failed
    steps: int
    message: str = ""  # reason of a failure; else empty

    def as_dict(self, measure: str) -> dict[str, object]:
        """Return a row of ``stiffmbs compare --json``; a failed run has a message, and None as error and time."""
        found = {"solver": self.solver, "setting": self.setting, "error": _finite(self.errors.get(measure, np.nan))}
        stated = {"message": self.message} if self.message else {}
        return {**found, "seconds": _finite(self.seconds), "steps": self.steps, **stated}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


@dataclass(frozen=True)
class AtError:
    """Run times at one error.

    `seconds`, `steps`: values of each solver that reaches the error. `better`: solvers whose every setting is more
    accurate; their time is that of the fastest setting.
    """

    error: float
    seconds: Mapping[str, float]
    steps: Mapping[str, float]
    better: tuple[str, ...]

    @property
    def fastest(self) -> str:
        """Return the solver with the least time."""
        return min(self.seconds, key=lambda name: self.seconds[name])

    def as_dict(self) -> dict[str, object]:
        """Return an entry of ``at_errors`` in ``stiffmbs compare --json``."""
        return {
            "error": self.error,
            "seconds": dict(self.seconds),
            "fastest": self.fastest,
            "better": list(self.better),
        }


def decades(rows: Sequence[Row], measure: str, resolved: float) -> list[float]:
    """Return the powers of ten within the measured errors, the largest first; the next above `resolved` if none is.

    The list is empty if all errors are exactly zero, as for a scene at rest.
    """
    errors = [row.errors[measure] for row in rows if row.errors and np.isfinite(row.errors[measure])]
    known = [error for error in errors if error > resolved]
    if not known:
        return [10.0 ** int(np.ceil(np.log10(resolved)))] if errors and resolved > 0.0 else []
    least, most = np.log10([min(known), max(known)])
    return [10.0**k for k in range(int(np.ceil(most)), int(np.ceil(least)) - 1, -1)]


def times_at(rows: Sequence[Row], measure: str, resolved: float, targets: Sequence[float]) -> Iterator[AtError]:
    """Yield run times at given errors, interpolated between the neighbouring measurements.

    `resolved`: error below which errors are not resolved.
    """
    done = [row for row in rows if row.errors and np.isfinite(row.errors[measure])]
    for target in targets:
        seconds: dict[str, float] = {}
        steps: dict[str, float] = {}
        better = []
        for solver in dict.fromkeys(row.solver for row in done):
            own = [row for row in done if row.solver == solver]
            if all(row.errors[measure] < target for row in own):
                quickest = min(own, key=lambda row: row.seconds)
                seconds[solver], steps[solver] = quickest.seconds, quickest.steps
                better.append(solver)
                continue
            known = [row for row in own if row.errors[measure] > resolved]
            read = _read(known, measure, [row.seconds for row in known], target)
            if read is not None:
                seconds[solver] = read
                steps[solver] = _read(known, measure, [row.steps for row in known], target) or 0.0
        if seconds:
            yield AtError(target, seconds, steps, tuple(better))


def _read(rows: Sequence[Row], measure: str, values: Sequence[float], target: float) -> float | None:
    """Return the interpolated value of one solver at an error, or None if all its errors are on one side."""
    least = [max(value, CLOCK) for value in values]
    return value_at_error(zip((row.errors[measure] for row in rows), least, strict=True), target)

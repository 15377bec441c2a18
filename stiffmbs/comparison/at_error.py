"""Run times at equal errors, interpolated between measurements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .interpolation import value_at_error
from .row import Row

CLOCK_RESOLUTION = 1e-9
"""Least time of a solution, s, as clocks may show zero."""


@dataclass(frozen=True)
class AtError:
    """Run times at one error.

    Attributes
    ----------
    error : float
    seconds, steps : mappings of str to float
        Values of each solver that reaches the error.
    better : tuple of str
        Solvers whose every setting is more accurate; their time is that of the fastest setting.
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
    """Return the powers of ten within the measured errors, the largest first; the next above `resolved` if none is."""
    errors = [row.errors[measure] for row in rows if row.errors and np.isfinite(row.errors[measure])]
    known = [error for error in errors if error > resolved]
    if not known:
        return [10.0 ** int(np.ceil(np.log10(resolved)))] if errors else []
    least, most = np.log10([min(known), max(known)])
    return [10.0**k for k in range(int(np.ceil(most)), int(np.ceil(least)) - 1, -1)]


def times_at(rows: Sequence[Row], measure: str, resolved: float, targets: Sequence[float]) -> Iterator[AtError]:
    """Yield run times at given errors, interpolated between the neighbouring measurements.

    Parameters
    ----------
    rows : sequence of Row
    measure : str
    resolved : float
        Error below which errors are not resolved.
    targets : sequence of float
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
    least = [max(value, CLOCK_RESOLUTION) for value in values]
    return value_at_error(zip((row.errors[measure] for row in rows), least, strict=True), target)

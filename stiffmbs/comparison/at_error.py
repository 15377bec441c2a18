"""Times at equal errors, between what was measured."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .interpolation import value_at_error
from .row import Row

CLOCK_RESOLUTION = 1e-9
"""Time, s, that a solution takes at the least: clocks may show none."""


@dataclass(frozen=True)
class AtError:
    """Times at one error.

    Attributes
    ----------
    error : float
    seconds, steps : mappings of str to float
        Of each solver that reaches the error.
    better : tuple of str
        Solvers of which every setting is more accurate than that; theirs is the time of the fastest setting.
    """

    error: float
    seconds: Mapping[str, float]
    steps: Mapping[str, float]
    better: tuple[str, ...]

    @property
    def fastest(self) -> str:
        """The solver that takes the least time."""
        return min(self.seconds, key=lambda name: self.seconds[name])

    def as_dict(self) -> dict[str, object]:
        """An entry of ``at_errors`` in ``stiffmbs compare --json``."""
        return {
            "error": self.error,
            "seconds": dict(self.seconds),
            "fastest": self.fastest,
            "better": list(self.better),
        }


def decades(rows: Sequence[Row], measure: str, resolved: float) -> list[float]:
    """Powers of ten among the errors that were measured, the largest first; just one above all where none is known."""
    errors = [row.errors[measure] for row in rows if row.errors and np.isfinite(row.errors[measure])]
    known = [error for error in errors if error > resolved]
    if not known:
        return [10.0 ** int(np.ceil(np.log10(resolved)))] if errors else []
    least, most = np.log10([min(known), max(known)])
    return [10.0**k for k in range(int(np.ceil(most)), int(np.ceil(least)) - 1, -1)]


def times_at(rows: Sequence[Row], measure: str, resolved: float, targets: Sequence[float]) -> Iterator[AtError]:
    """Times at errors, by lines through the measured points about each.

    Parameters
    ----------
    rows : sequence of Row
    measure : str
    resolved : float
        Errors below this are not known.
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
    """What one solver needs at an error, of values at each of its rows; None where its errors are all on one side."""
    least = [max(value, CLOCK_RESOLUTION) for value in values]
    return value_at_error(zip((row.errors[measure] for row in rows), least, strict=True), target)

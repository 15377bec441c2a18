"""Report of a simulation in real time: times of its steps, packets, and accuracy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np

from ..notes import note_lines
from ..results.solution import Solution
from ..solve.trajectory import Outcome
from .accuracy import Accuracy, Difference
from .exchange import Exchanged

PERCENTAGES: Final = (50.0, 99.0, 99.99)
"""Percentages of the steps whose largest times are in the report: those in which real time is usually specified."""


@dataclass(frozen=True, repr=False)
class RealTime:
    """Times and accuracy of steps in real time.

    Attributes
    ----------
    name : str
    solver : str
    step : float
        Time step, s.
    start : float
        Time at the start, s.
    requested : int
        Number of steps that were to be taken.
    spent : ndarray, shape (steps,)
        Time of each step, s: inputs, solution, outputs, without waiting.
    measured : str
        ``processor time``, or on Windows ``elapsed time``.
    late : ndarray, shape (steps,), or None
        Times by which steps ended after the next one was due, s; negative if before it. None if steps were not paced.
    outcome : Outcome
    message : str
        Sentence on the end of the steps.
    channels : tuple of str
        Outputs that were read after each step.
    exchanged : Exchanged or None
        Numbers of packets, if inputs and outputs were exchanged.
    accuracy : Accuracy
        Differences from a run with error control.
    solution : Solution or None
        Results of the steps at output times; None if inputs were exchanged, as they changed between output times.
    notes : tuple of str
    """

    name: str
    solver: str
    step: float
    start: float
    requested: int
    spent: np.ndarray
    measured: str
    late: np.ndarray | None
    outcome: Outcome
    message: str
    channels: tuple[str, ...]
    exchanged: Exchanged | None
    accuracy: Accuracy
    solution: Solution | None
    notes: tuple[str, ...]

    @property
    def steps(self) -> int:
        """Return the number of steps."""
        return len(self.spent)

    @property
    def mean(self) -> float:
        """Return the mean time of a step, s; NaN without steps."""
        return float(self.spent.mean()) if self.steps else np.nan

    @property
    def longest(self) -> float:
        """Return the longest time of a step, s; NaN without steps."""
        return float(self.spent.max()) if self.steps else np.nan

    @property
    def longest_at(self) -> float:
        """Return the time at the end of the longest step, s; NaN without steps."""
        return self._end_of(int(self.spent.argmax())) if self.steps else np.nan

    @property
    def above(self) -> int:
        """Return the number of steps that took longer than the time step."""
        return int((self.spent > self.step).sum())

    @property
    def overruns(self) -> int | None:
        """Return the number of steps that ended after the next one was due; None if steps were not paced."""
        return None if self.late is None else int((self.late > 0).sum())

    def percentile(self, percentage: float) -> float:
        """Return the least time of a step, s, that a percentage of the steps does not exceed; NaN without steps."""
        return float(self._sorted[max(int(np.ceil(percentage / 100 * self.steps)), 1) - 1]) if self.steps else np.nan

    @cached_property
    def _sorted(self) -> np.ndarray:
        return np.sort(self.spent)

    def _end_of(self, step: int) -> float:
        return self.start + (step + 1) * self.step

    def as_dict(self, scene: str) -> dict[str, Any]:
        """Return what ``stiffmbs realtime --json`` prints."""
        found: dict[str, Any] = {
            "scene": scene, "status": "done" if self.outcome is Outcome.DONE else "stopped", "message": self.message,
            "solver": self.solver, "step": self.step, "steps": self.steps, "requested": self.requested,
            "times": {
                "measured": self.measured, "mean": self.mean,
                **{f"{percentage:g} %": self.percentile(percentage) for percentage in PERCENTAGES},
                "longest": self.longest, "t_longest": self.longest_at, "above_step": self.above,
            },
            "accuracy": {
                "solver": self.accuracy.solver, "message": self.accuracy.message, "end": self.accuracy.end,
                "differences": [vars(one) for one in self.accuracy.differences],
            },
            "notes": list(map(str, self.notes)),
        }  # fmt: skip
        if self.late is not None:
            found["overruns"] = {"steps": self.overruns, "latest": self._latest}
        if self.exchanged is not None:
            found["udp"] = vars(self.exchanged)
        return found

    @property
    def _latest(self) -> float:
        return float(self.late.max()) if self.late is not None and self.steps else np.nan

    def __str__(self) -> str:
        """Return what ``stiffmbs realtime`` prints."""
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        pace = "as fast as possible" if self.late is None else "paced by the clock"
        yield f"{self.name or 'model'}: {self.steps} of {self.requested} steps of {duration(self.step)} by {self.solver}, {pace}"
        if self.steps:
            yield from self._lines_of_times()
        if self.exchanged is not None:
            yield from self.exchanged.sentences()
        yield from self._lines_of_accuracy()
        yield from note_lines(self.notes)

    def _lines_of_times(self) -> Iterator[str]:
        parts = [f"{percentage:g} % {duration(self.percentile(percentage))}" for percentage in PERCENTAGES]
        longest = f"longest {duration(self.longest)} at t = {self.longest_at:.6g} s"
        yield f"{self.measured} of a step: mean {duration(self.mean)}, {', '.join(parts)}, {longest}"
        yield f"longer than a step of {duration(self.step)}: {self.above} steps ({self.above / self.steps:.3%})"
        if self.late is not None:
            latest = f", by {duration(self._latest)} at most" if self.overruns else ""
            yield f"behind the clock: {self.overruns} steps ended after the next one was due ({(self.overruns or 0) / self.steps:.3%}){latest}"

    def _lines_of_accuracy(self) -> Iterator[str]:
        if self.accuracy.differences:
            yield f"largest differences from {self.accuracy.solver}, up to t = {self.accuracy.end:.6g} s:"
            rows = [
                (one.kind, f"{one.largest:.2g} {one.unit}", _of(one), f"{one.channel} at t = {one.t:.4g} s")
                for one in self.accuracy.differences
            ]
            widths = [max(map(len, column)) for column in list(zip(*rows, strict=True))[:-1]]
            for *cells, last in rows:
                padded = [cell.ljust(width) for cell, width in zip(cells, widths, strict=True)]
                yield "  ".join(["", *padded, last])
        if self.accuracy.message:
            yield f"accuracy: {self.accuracy.message}"


def _of(one: Difference) -> str:
    return "" if np.isnan(one.size) else f"of {one.size:.3g} {one.unit}"


def duration(seconds: float) -> str:
    """Return a time with three digits in s, ms or us."""
    if not np.isfinite(seconds):
        return "-"
    unit, factor = next(
        ((unit, factor) for unit, factor in (("s", 1.0), ("ms", 1e3)) if seconds * factor >= 1), ("us", 1e6)
    )
    return f"{seconds * factor:.3g} {unit}"

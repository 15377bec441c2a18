"""Outcome of the estimate of the errors of a run."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class ErrorEstimate:
    """Outcome of the estimate of the errors of a run.

    - `status`: ``estimated``, ``lost`` (the errors are too large for a linear estimate) or ``none``.
    - `sentence`: for the summary.
    - `largest`: channel with the largest error relative to its size, and `relative`: that error; empty and nan if unknown.
    - `resolved`: least size of motions and velocities to which their errors are relative, m, rad, m/s, rad/s; smaller ones
      are not distinguished from rest.
    - `reached`: the accuracy that was asked for and reached, in words; part of the sentence, too.
    """

    status: str
    sentence: str
    largest: str = ""
    relative: float = float("nan")
    resolved: float = 0.0
    reached: str = ""

    def with_accuracy(self, reached: str) -> ErrorEstimate:
        """Return the estimate with what was reached of the accuracy asked for, in words."""
        return replace(self, sentence=f"{self.sentence}; {reached}", reached=reached) if reached else self

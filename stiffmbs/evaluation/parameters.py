"""Parameters of the evaluation of runs."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Evaluation:
    """Parameters of loads, driving angles, cycles and peaks.

    Source: tests/evaluation, and of `alike` the reference of `stiffmbs.evaluation.cycle`.
    """

    zero: float = 1e-11
    """Part of the largest load, or of the energy of the motion, below which a load or energy is rounding."""
    missing_turn: float = 1e-6
    """Part of a revolution that may be missing, for durations written with six digits."""
    alike: float = 0.1
    """Difference of a signal from itself at a lag, relative to the mean over smaller lags, below which the lag is a period."""
    samples: int = 4
    """Samples in the mean interval of output instants: a period need not be a multiple of it."""
    rounds: int = 2
    """Number of times that the intervals around the least and the greatest value are divided."""
    parts: int = 16
    """Parts of these intervals."""


EVALUATION = Evaluation()

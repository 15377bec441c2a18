"""Prediction of a run's time on drafts of compiled code: a long run pays for compiling its code at the full level first."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from ..compile.machine.drafts import number_used
from ..solve.trajectory import ProgressCallback


@dataclass(frozen=True)
class Drafted:
    """Parameters of runs on drafts.

    - `patience`: processor time, s, that the rest of a run may take on drafts. A longer run starts again on fully compiled code, on
      which it takes a third of the time; to compile it takes a few seconds.
    - `least`: processor time, s, of the part of a run from which the rest is predicted. Steps are short at first.
    """

    patience: float = 10.0
    least: float = 1.0


DRAFTED = Drafted()


class TakesLongError(Exception):
    """A run on drafts takes longer than to compile its code and to start again."""


class Predicted:
    """Progress callback that raises TakesLongError when the rest of a run on drafts takes too long.

    Intervals in which code was compiled say nothing about the rest. Results do not depend on it, because both levels of
    compilation give bit-equal results.
    """

    def __init__(self, end: float, watch: ProgressCallback, parameters: Drafted = DRAFTED) -> None:
        self._end, self._watch, self._parameters = end, watch, parameters
        self._last = self._now = math.inf
        self._drafts = 0

    def __call__(self, t: float) -> None:
        self._watch(t)
        now, drafts = time.process_time(), number_used()
        if t < self._last:  # at first, and where a repeated run begins
            self._spent = self._gone = 0.0
        elif drafts == self._drafts:
            self._spent += now - self._now
            self._gone += t - self._last
        self._last, self._now, self._drafts = t, now, drafts
        if (
            self._spent > self._parameters.least
            and self._spent * (self._end - t) > self._parameters.patience * self._gone
        ):
            raise TakesLongError

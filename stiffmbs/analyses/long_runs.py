"""Prediction of a run's time on drafts of compiled code: a long run pays for compiling its code at the full level first."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

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

    Results do not depend on it, because both levels of compilation give bit-equal results.
    """

    def __init__(self, end: float, watch: ProgressCallback, parameters: Drafted = DRAFTED) -> None:
        self._end, self._watch, self._parameters = end, watch, parameters
        self._first = self._last = math.inf

    def __call__(self, t: float) -> None:
        self._watch(t)
        if t < self._last:  # at first, and where a repeated run begins; earlier time was spent on compiling
            self._first, self._begin = t, time.process_time()
        self._last = t
        spent = time.process_time() - self._begin
        if spent > self._parameters.least and spent * (self._end - t) > self._parameters.patience * (t - self._first):
            raise TakesLongError

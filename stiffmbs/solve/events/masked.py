"""Switches that stay about zero: left alone for a while where the force has a breakpoint there, told where it jumps.

A contact whose gap is zero at the start, or max(0, x) at rest, changes its sign by rounding alone.  A force without a
jump loses nothing when the integrator goes on across its breakpoint.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..dynamics import Dynamics
from .chattering import Chattering, jump_sentence
from .discontinuity import jumping

FEW_STEPS, TIMES_THE_WAIT = 4, 4
"""An event within so many steps of a start, and of the wait before, counts as one by rounding."""
FIRST_WAIT, LONGER, MOST_IN_SUCCESSION = 8, 4, 5
"""Steps for which an event function is masked after its second event of a kind, factor for each further event, and upper bound: the
first steps after a start double in size.  A single repetition may be an event detected twice, because the start is projected onto
the constraints."""
TELLING = 3
"""Such events in succession from which on a force that jumps is told; the first may be those of a start at zero."""


class MaskedEvents:
    """The event functions of one run, and how long each is to be left alone.

    Parameters
    ----------
    dynamics : Dynamics
    chattering : Chattering
        Of the same run.

    Attributes
    ----------
    steps : ndarray of int
        Steps from the next start on for which each event_function is not to be looked at.
    """

    def __init__(self, dynamics: Dynamics, chattering: Chattering) -> None:
        self._dynamics, self._chattering = dynamics, chattering
        n = dynamics.system.n_event_functions
        self.steps, self._in_succession = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
        self._steps, self._quiet = 0, True

    @property
    def any(self) -> bool:
        """Whether the system has event functions."""
        return bool(len(self.steps))

    def note(self, t: float, q: np.ndarray, u: np.ndarray, steps: int, fired: Sequence[int]) -> None:
        """Take note of the end of a segment, after so many steps of the run, by the event functions that have fired.

        Raises
        ------
        SolverError
            Where a force keeps jumping back and forth; names the element.
        """
        since, self._steps = steps - self._steps, steps
        if self._quiet and since > FEW_STEPS:  # none is left alone, and none comes soon
            return
        left_behind = since > TIMES_THE_WAIT * self.steps + FEW_STEPS
        self._in_succession[left_behind] = 0
        again = np.array(
            [event_function for event_function in fired if not left_behind[event_function]], dtype=np.int64
        )
        self._in_succession[again] = np.minimum(self._in_succession[again] + 1, MOST_IN_SUCCESSION)
        telling = again[self._in_succession[again] >= TELLING]
        if len(telling):
            self._chattering.refuse(t, np.intersect1d(telling, jumping(self._dynamics, t, q, u)))
        self.steps = np.where(self._in_succession > 1, FIRST_WAIT * LONGER ** np.maximum(self._in_succession - 2, 0), 0)
        self._quiet = not self._in_succession.any()

    def failed(self, t: float, q: np.ndarray, u: np.ndarray) -> str:
        """Why the integrator could not go on, where a force that jumps is the reason; empty for other reasons."""
        found = jumping(self._dynamics, t, q, u) if self.any else self.steps
        return jump_sentence(self._dynamics, int(found[0])) if len(found) else ""

"""Masking of event functions that stay near zero, if the force is continuous there; a jump is reported.

A contact with zero gap at the start, or max(0, x) at rest, changes its sign by rounding alone.  Without a jump of the
force, the integrator may ignore the breakpoint.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..dynamics import Dynamics
from .chattering import Chattering, jump_sentence
from .discontinuity import jumping

FEW_STEPS, TIMES_THE_WAIT = 4, 4
"""Steps after a start, and multiple of the preceding wait, within which an event is attributed to rounding."""
FIRST_WAIT, LONGER, MOST_IN_SUCCESSION = 8, 4, 5
"""Steps for which an event function is masked after its second such event, factor for each further event, and largest
count.  A single repetition may be an event that is detected twice, because the start is projected onto constraints."""
TELLING = 3
"""Successive events from which a force is checked for a jump; the first may be those of a start at zero."""


class MaskedEvents:
    """Event functions of one run, and the steps for which each is masked.

    Parameters
    ----------
    dynamics : Dynamics
    chattering : Chattering
        Monitor of the same run.

    Attributes
    ----------
    steps : ndarray of int
        Steps from the next start for which each event function is masked.
    """

    def __init__(self, dynamics: Dynamics, chattering: Chattering) -> None:
        self._dynamics, self._chattering = dynamics, chattering
        n = dynamics.system.n_event_functions
        self.steps, self._in_succession = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
        self._steps, self._quiet = 0, True

    @property
    def any(self) -> bool:
        """Return True if the system has event functions."""
        return bool(len(self.steps))

    def note(self, t: float, q: np.ndarray, u: np.ndarray, steps: int, fired: Sequence[int]) -> None:
        """Record the events that ended a segment, after `steps` steps of the run.

        Raises
        ------
        SolverError
            If a force keeps chattering; names the element.
        """
        since, self._steps = steps - self._steps, steps
        if self._quiet and since > FEW_STEPS:  # none is masked, and the event is not soon after the last
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
        """Return a sentence on a discontinuous force that made the integrator fail; empty for other causes."""
        found = jumping(self._dynamics, t, q, u) if self.any else self.steps
        return jump_sentence(self._dynamics, int(found[0])) if len(found) else ""

"""Masking of event functions that stay near zero, if the force is continuous there; a jump is reported.

A contact with zero gap at the start, or max(0, x) at rest, changes its sign by rounding alone.  Without a jump of the
force, the integrator may ignore the breakpoint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...dynamics.dynamics import Dynamics
from ...tuning import tuned
from .chattering import Chattering, jump_sentence
from .discontinuity import jumping


@dataclass(frozen=True)
class MaskingParameters:
    """Parameters that decide when an event function is masked, and for how many steps."""

    few_steps: int = 4
    """Steps after a start within which an event is attributed to rounding."""
    times_the_wait: int = 4
    """The same as a multiple of the preceding wait."""
    first_wait: int = 8
    """Steps for which an event function is masked after its second such event. A single repetition may be an event that
    is detected twice, because the start is projected onto constraints."""
    longer: int = 4
    """Factor of the wait for each further event."""
    most_in_succession: int = 5
    """Largest number of events that count."""
    telling: int = 3
    """Successive events from which a force is checked for a jump; the first may be those of a start at zero."""


MASKING = tuned("masking", MaskingParameters())


class MaskedEvents:
    """Event functions of one run, and the steps for which each is masked.

    `chattering`: monitor of the same run. `steps`: steps from the next start for which each event function is masked.
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

        Raises SolverError if a force keeps chattering; names the element.
        """
        since, self._steps = steps - self._steps, steps
        if self._quiet and since > MASKING.few_steps:  # none is masked, and the event is not soon after the last
            return
        left_behind = since > MASKING.times_the_wait * self.steps + MASKING.few_steps
        self._in_succession[left_behind] = 0
        again = np.array(
            [event_function for event_function in fired if not left_behind[event_function]], dtype=np.int64
        )
        self._in_succession[again] = np.minimum(self._in_succession[again] + 1, MASKING.most_in_succession)
        telling = again[self._in_succession[again] >= MASKING.telling]
        if len(telling):
            self._chattering.refuse(t, np.intersect1d(telling, jumping(self._dynamics, t, q, u)))
        self.steps = np.where(
            self._in_succession > 1, MASKING.first_wait * MASKING.longer ** np.maximum(self._in_succession - 2, 0), 0
        )
        self._quiet = not self._in_succession.any()

    def failed(self, t: float, q: np.ndarray, u: np.ndarray) -> str:
        """Return a sentence on a discontinuous force that made the integrator fail; empty for other causes."""
        found = jumping(self._dynamics, t, q, u) if self.any else self.steps
        return jump_sentence(self._dynamics, int(found[0])) if len(found) else ""

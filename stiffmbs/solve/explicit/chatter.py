"""Forces that jump back and forth across a corner where the motion stays, as dry friction at rest: told, not followed."""

from __future__ import annotations

from collections import deque

from ...compile.system import System
from ...errors import SolverError

MOST_EVENTS, FEWEST_STEPS = 500, 2.5
"""So many events in a row with fewer steps between them on average: an impact takes more than its two ends."""


class Chatter:
    """The last events of a run."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._last: deque[tuple[float, int]] = deque(maxlen=MOST_EVENTS)

    def note(self, t: float, steps: int, switch: int) -> None:
        """Take note of an event, the change of a switch (below zero where none is known).

        Raises
        ------
        SolverError
            When the last events came one upon the other; names the element.
        """
        self._last.append((t, steps))
        since, before = self._last[0]
        if len(self._last) == MOST_EVENTS and steps - before < FEWEST_STEPS * MOST_EVENTS:
            name = f"'{self._system.writer('switch', switch)}'" if switch >= 0 else "a force"
            raise SolverError(
                f"stopped at t = {t:.9g} s: {name} has changed its law {MOST_EVENTS} times since "
                f"t = {since:.9g} s, as a force does that jumps where the motion comes to rest; expected one that is "
                "steep there, without a jump"
            )

"""Report of velocity jumps prescribed by drives at breakpoints; their impulses appear in no reaction."""

from __future__ import annotations

import numpy as np

from ..dynamics import Dynamics

MOST_MESSAGES = 3
"""Largest number of jumps reported one by one."""
WORTH_TELLING = 1e-2
"""Velocity change at a breakpoint, relative to the largest velocity, above which it is a jump."""


class VelocityJumps:
    """Velocity jumps of one run.

    Parameters
    ----------
    dynamics : Dynamics
    """

    def __init__(self, dynamics: Dynamics) -> None:
        self._dynamics = dynamics
        self._messages: list[str] = []

    def note(self, t: float, change: np.ndarray) -> None:
        """Note a change of velocities at a breakpoint; the state of the dynamics is that after it."""
        if not (np.abs(change) > WORTH_TELLING).any():
            return
        k = int(np.argmax(np.abs(change)))
        if abs(change[k]) > WORTH_TELLING * max(1.0, float(np.max(np.abs(self._dynamics.state.u)))):
            system = self._dynamics.system
            name = system.name_of(k, system.of_body.velocities)
            self._messages.append(
                f"at t = {t:.6g} s a drive makes velocities jump ({name} by {change[k]:.3g}); no force shows that blow"
            )

    def clear(self) -> None:
        """Forget the jumps before another run."""
        self._messages.clear()

    def sentence(self) -> str:
        """Return a sentence on the jumps for the user; empty if there are none."""
        more = len(self._messages) - MOST_MESSAGES
        return "; ".join([*self._messages[:MOST_MESSAGES], *([f"and {more} more such jumps"] if more > 0 else [])])

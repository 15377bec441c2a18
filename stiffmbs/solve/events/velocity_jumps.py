"""Report of velocity jumps prescribed by drives at breakpoints; their impulses appear in no reaction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...dynamics.dynamics import Dynamics
from ...tuning import tuned


@dataclass(frozen=True)
class VelocityJumpParameters:
    """Parameters of the report."""

    least: float = 1e-2
    """Velocity change at a breakpoint, relative to the largest velocity, above which it is a jump."""
    most_messages: int = 3
    """Largest number of jumps reported one by one."""


VELOCITY_JUMP = tuned("velocity_jumps", VelocityJumpParameters())


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
        if not (np.abs(change) > VELOCITY_JUMP.least).any():
            return
        k = int(np.argmax(np.abs(change)))
        if abs(change[k]) > VELOCITY_JUMP.least * max(1.0, float(np.max(np.abs(self._dynamics.state.u)))):
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
        more = len(self._messages) - VELOCITY_JUMP.most_messages
        return "; ".join(
            [*self._messages[: VELOCITY_JUMP.most_messages], *([f"and {more} more such jumps"] if more > 0 else [])]
        )

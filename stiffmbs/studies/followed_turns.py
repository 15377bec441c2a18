"""Full revolutions of joint angles over the steps of a simulation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..analyses.job import Job
from ..results.joint_angles import TURN, joint_angles

MOST_KEPT = 1000
"""Number of states that are kept before their angles are computed."""


class FollowedTurns:
    """Continuous angles of the spatial joints whose turns the integration does not count.

    They follow from the rates at the ends of all steps, as in a run with these output times.

    Parameters
    ----------
    t : float
        Start, s.
    q, u : ndarrays, shapes (n_q,), (n_u,)
    known : mapping of str to float
        Channels at the start, with angles in their turns.
    """

    def __init__(self, job: Job, t: float, q: np.ndarray, u: np.ndarray, known: Mapping[str, float]) -> None:
        self._dynamics = job.dynamics
        self._angles = joint_angles(job.dynamics.system, job.data.joints)
        self._known = dict(known)
        self.any = self._angles is not None and bool(self._angles.followed)
        self._states = [(t, q.copy(), u.copy())]

    def note(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """Keep the state at the end of a step."""
        self._states.append((t, q.copy(), u.copy()))
        if len(self._states) > MOST_KEPT:
            self.angles()

    def angles(self) -> dict[str, float]:
        """Return the angles at the last state, rad, by channel."""
        assert self._angles is not None
        t, q, u = (np.array(each) for each in zip(*self._states, strict=True))
        with self._dynamics.state.unchanged():
            rows = self._dynamics.report(t, q, u, project=False)
        if len(rows.t):
            found = self._angles.continuous(rows)
            self._known = {
                name: found[name].item(-1) + TURN * round((self._known.get(name, first) - first) / TURN)
                for name, first in ((name, found[name].item(0)) for name in self._angles.followed)
            }
            self._states = self._states[-1:]
        return self._known

"""Report of the estimated errors that accumulate over a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...compile.system import System
from ...model.settings import DEFAULT_RTOL, RunSettings
from ...tuning import tuned
from .tolerances import absolute_tolerances


@dataclass(frozen=True)
class AccumulatedErrors:
    """Threshold above which accumulated errors of positions are reported.

    `tolerances`: estimated error of a position, in units of its tolerance, above which it is reported. `usual_rtol`:
    smallest relative tolerance that errors are compared with: that of a run without settings.
    """

    tolerances: float = 100.0
    usual_rtol: float = DEFAULT_RTOL

    def counted(self, system: System, settings: RunSettings) -> tuple[np.ndarray, float]:
        """Return absolute, shape (n_u,), m and rad, and relative tolerance of the displacement along each velocity."""
        usual = settings.model_copy(update={"rtol": self.usual_rtol, "atol": None})
        of_both = (absolute_tolerances(system, each)[system.n_q :] for each in (settings, usual))
        return np.fmax(*of_both), max(settings.rtol, self.usual_rtol)

    def in_tolerances(self, system: System, settings: RunSettings, displaced: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Return the estimated errors of positions in units of their tolerances, shape (n_u,).

        `displaced` of shape (n_u,): estimated errors, m and rad. `q` of shape (n, n_q): positions during the run; they
        scale the tolerances of displacements, not those of angles.
        """
        absolute, relative = self.counted(system, settings)
        bodies, of_body = len(system.bodies), system.of_body
        largest = np.nanmax(np.abs(q[:, : system.n_pose]), axis=0).reshape(bodies, of_body.n_q)
        allowed = absolute.reshape(bodies, of_body.n_u).copy()
        allowed[:, : of_body.linear] += relative * largest[:, : of_body.linear]
        found: np.ndarray = displaced / allowed.ravel()
        return found


ACCUMULATED = tuned("accumulated_errors", AccumulatedErrors())
"""Threshold of every run."""

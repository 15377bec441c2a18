"""When errors that the steps of a run add up to are reported."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...compile.system import System
from ...describe.settings import RunSettings
from .tolerances import absolute_tolerances


@dataclass(frozen=True)
class AccumulatedErrors:
    """When estimated errors of positions are reported.

    Attributes
    ----------
    tolerances : float
        Error of a position, in tolerances of it, from which on it is reported.  A run keeps each step within the tolerance, and nobody
        expects less than a hundred of them by its end.
    usual_rtol : float
        Relative tolerance below which none is counted: that of a run without settings.  A tighter one asks for what can be had.
    """

    tolerances: float = 100.0
    usual_rtol: float = 1e-6

    def counted(self, system: System, settings: RunSettings) -> tuple[np.ndarray, float]:
        """Return the absolute tolerance of each displacement along a velocity, shape (n_u,), m and rad, and the relative tolerance."""
        usual = settings.model_copy(update={"rtol": self.usual_rtol, "atol": None})
        of_both = (absolute_tolerances(system, each)[system.n_q :] for each in (settings, usual))
        return np.fmax(*of_both), max(settings.rtol, self.usual_rtol)

    def in_tolerances(self, system: System, settings: RunSettings, displaced: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Return estimated errors in tolerances of the positions, shape (n_u,).

        Parameters
        ----------
        displaced : ndarray, shape (n_u,)
            m and rad.
        q : ndarray, shape (n, n_q)
            Of the run: the tolerance of a displacement grows with it, that of an angle does not.
        """
        absolute, relative = self.counted(system, settings)
        bodies, of_body = len(system.bodies), system.of_body
        largest = np.nanmax(np.abs(q[:, : system.n_pose]), axis=0).reshape(bodies, of_body.n_q)
        allowed = absolute.reshape(bodies, of_body.n_u).copy()
        allowed[:, : of_body.linear] += relative * largest[:, : of_body.linear]
        found: np.ndarray = displaced / allowed.ravel()
        return found


ACCUMULATED = AccumulatedErrors()
"""That of every run."""

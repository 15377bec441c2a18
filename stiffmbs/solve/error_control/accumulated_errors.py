"""Estimated errors that accumulate over a run: their memory, and their report."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...compile.coordinates import FIXED, Coordinates
from ...compile.machine.layout import DTYPES, packed
from ...compile.system import System, Term
from ...model.settings import DEFAULT_RTOL, RunSettings
from ...tuning import tuned
from .native.layouts import ACCUMULATED_ERRORS
from .tolerances import absolute_tolerances

SUMS = "displaced", "furthest", "each", "damping", "speed_error", "path"


class ErrorSums:
    """Memory of accumulated errors.

    `place`: positions of the velocities among the unknowns, shape (n_u,). `f_u`: entries of the derivatives of forces by
    velocities, in the values of the iteration matrix; without entries the damping is noted instead.
    `table`: addresses and cells for compiled code (`stiffmbs.solve.error_control.native.layouts.ACCUMULATED_ERRORS`).
    """

    def __init__(self, system: System, coordinates: Coordinates, place: np.ndarray, f_u: Term) -> None:
        leader, self._ratio = coordinates.u_independent_of, coordinates.u_ratio
        moving, group = leader != FIXED, system.velocity_groups
        independent = np.flatnonzero(coordinates.independent_u)
        order = independent[np.argsort(group[independent], kind="stable")]
        groups, first = np.unique(group[order], return_index=True)
        self._follows = np.zeros(system.n_u, dtype=np.int64)
        self._follows[order] = np.arange(len(order))
        self._follows = self._follows[leader]  # the ratio of a fixed velocity is zero
        mass = np.zeros(system.n_u)
        np.add.at(mass, leader[moving], (self._ratio**2 * system.mass)[moving])
        of_row = np.searchsorted(groups, group[f_u.row])
        kept = np.argsort(of_row, kind="stable")
        kept = kept[(moving[f_u.row] & moving[f_u.column])[kept]]
        source, row, column = (part[kept] for part in f_u)
        self._arrays = {
            "first": np.append(first, len(order)), "place": place[order], "mass": mass[order],
            "first_damped": np.searchsorted(of_row[kept], np.arange(len(groups) + 1)), "damped_source": source,
            "damped_row": place[leader[row]], "damped_column": place[leader[column]], "damped_factor": self._ratio[row] * self._ratio[column],
        }  # fmt: skip
        self._arrays = {
            name: np.append(array, 0).astype(DTYPES[ACCUMULATED_ERRORS[name]]) for name, array in self._arrays.items()
        }
        self._sums = np.zeros((len(SUMS), len(order) + 1))
        sums = dict(zip(SUMS, self._sums, strict=True))
        self.table = packed(ACCUMULATED_ERRORS, {**self._arrays, **sums, "n_groups": len(groups)})
        self._new = self.table.copy()

    def displaced(self) -> np.ndarray:
        """Return the largest accumulated errors of positions along all velocities, shape (n_u,), m and rad."""
        found: np.ndarray = np.abs(self._ratio) * self._sums[SUMS.index("furthest")][self._follows]
        return found

    def forget(self) -> None:
        """Reset all sums for a new run."""
        self.table[:], self._sums[:] = self._new, 0.0


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

"""What the local errors of a run come to: estimated errors of positions, and when they are reported."""

from __future__ import annotations

import numpy as np

from ...compile.coordinates import FIXED
from ...compile.equations import Equations
from ...compile.machine.layout import packed
from ...compile.system import System, Term
from ..native.tables.steps import ACCUMULATED_ERRORS


class ErrorSums:
    """Memory of the local errors that are added up during a run (`stiffmbs.solve.native.accumulated_errors`).

    Parameters
    ----------
    place : ndarray of int
        Where the integrated velocities stand among the unknowns.
    mass : ndarray
        Their masses, with those of the velocities that move with them.
    follows, ratio : ndarrays, shapes (n_u,)
        Number of the integrated velocity that each velocity moves with, and by which factor.
    damped : Term, optional
        Derivatives of forces by velocities, where compiled code has them.

    Attributes
    ----------
    table : ndarray of int
        For compiled code.
    """

    def __init__(
        self, place: np.ndarray, mass: np.ndarray, follows: np.ndarray, ratio: np.ndarray, damped: Term | None = None
    ) -> None:
        self._follows, self._ratio = follows, ratio
        self._sums = np.zeros((2, max(len(place), 1)))
        self._kept = {"place": np.append(place, 0).astype(np.int64), "mass": np.append(mass, 0.0)}
        self._kept |= _damped(damped, self._kept["place"], follows, ratio)
        self.table = packed(
            ACCUMULATED_ERRORS,
            {
                "n": len(place),
                "n_damped": len(damped.source) if damped else 0,
                **self._kept,
                "displaced": self._sums[0],
                "furthest": self._sums[1],
            },
        )
        self._cells = self.table.view(ACCUMULATED_ERRORS.cells)[0]

    @classmethod
    def of_equations(cls, equations: Equations) -> ErrorSums:
        """For the unknowns of IDA."""
        coordinates, mass = equations.coordinates, equations.system.mass
        independent = coordinates.independent_u
        leader, ratio = coordinates.relation("u")
        moves = leader != FIXED
        number = np.cumsum(independent) - 1
        follows = np.where(moves, number[leader], 0)
        carried = np.zeros(int(independent.sum()))
        np.add.at(carried, follows[moves], (ratio**2 * mass)[moves])
        damped = equations.system.term(equations.formulation.matrix_set, "f_u")
        return cls(equations.at["u"][independent], carried, follows, ratio, damped)

    @classmethod
    def of_velocities(cls, system: System) -> ErrorSums:
        """For states (q, u) of all coordinates and velocities."""
        every = np.arange(system.n_u)
        return cls(system.n_q + every, system.mass, every, np.ones(system.n_u))

    def displaced(self) -> np.ndarray:
        """Estimated errors of all positions, as displacements along velocities, shape (n_u,)."""
        found: np.ndarray = np.abs(self._ratio) * self._sums[1, self._follows]
        return found

    def forget(self) -> None:
        """Begin with another run."""
        self._sums[:] = 0.0
        for cell in self._cells.dtype.names:
            self._cells[cell] = 0


def _damped(damped: Term | None, place: np.ndarray, follows: np.ndarray, ratio: np.ndarray) -> dict[str, np.ndarray]:
    """Entries of the derivatives of forces by velocities, in the places of the unknowns; an entry of zero at the end."""
    nothing = np.zeros(1, dtype=np.int64)
    if damped is None:
        return {"damped_source": nothing, "damped_row": nothing, "damped_column": nothing, "damped_factor": np.zeros(1)}
    return {
        "damped_source": np.append(damped.source, 0).astype(np.int64),
        "damped_row": np.append(place[follows[damped.row]], 0),
        "damped_column": np.append(place[follows[damped.column]], 0),
        "damped_factor": np.append(ratio[damped.row] * ratio[damped.column], 0.0),
    }

"""Stiffness of the scene, by which Newton's tolerance and long steps are chosen (`stiffmbs.solve.ida.native.start`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...compile.system import Term
from ...dynamics.dynamics import Dynamics


class Stiffness(NamedTuple):
    """Bounds of the stiffness and damping of the forces near a state.

    `of_positions`, `of_velocities`: largest row sums of M^-1/2 df/dq M^-1/2, 1/s^2, and of M^-1/2 df/du M^-1/2, 1/s.
    """

    of_positions: float
    of_velocities: float


def stiffness_at(dynamics: Dynamics, t: float) -> Stiffness:
    """Return the stiffness at the current state."""
    state = dynamics.state
    state.evaluate("tangent", t)
    sums = row_sums_of(dynamics)
    with np.errstate(over="ignore"):  # infinite for a body of nearly zero mass
        values = state.values["tangent"]
        return Stiffness(*(of_term.largest(values) for of_term in sums))


def row_sums_of(dynamics: Dynamics) -> tuple[RowSums, RowSums]:
    """Return the row sums of the derivatives of accelerations with respect to positions and velocities."""
    return dynamics.once(_row_sums)


def _row_sums(dynamics: Dynamics) -> tuple[RowSums, RowSums]:
    system = dynamics.system
    f_q, f_u = system.term("tangent", "f_q"), system.term("tangent", "f_u")
    return row_sums(f_q, system.mass, system.mass_by_coordinate), row_sums(f_u, system.mass, system.mass)


class RowSums(NamedTuple):
    """Absolute row sums of M^-1/2 A M^-1/2 for a term A.

    The largest bounds the eigenvalues of M^-1 A and does not depend on the units of lengths and angles.  A column of a
    coordinate without mass is scaled by the masses of the rows, as in M^-1 A. `source`, `row`: positions of the entries
    among the values of their term set, and their rows. `scales`: divisor of each entry. `n`: number of rows.
    """

    source: np.ndarray
    row: np.ndarray
    scales: np.ndarray
    n: int

    def largest(self, values: np.ndarray) -> float:
        """Return the largest row sum for the values of the term set."""
        sums = np.bincount(self.row, np.abs(values[self.source]) / self.scales, minlength=self.n)
        return float(sums.max()) if self.n else 0.0


def row_sums(term: Term, mass: np.ndarray, of_columns: np.ndarray) -> RowSums:
    """Return the row sums of a term, given the masses of its rows and columns."""
    of_rows, of_term = mass[term.row], of_columns[term.column]
    scales = np.sqrt(of_rows) * np.sqrt(np.where(of_term > 0, of_term, of_rows))
    return RowSums(term.source, term.row, scales, len(mass))

"""How far Newton's iteration has to be taken, and which steps are long, by the stiffness of the scene."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...compile.system import System, Term
from ...describe.settings import RunSettings
from ..dynamics import Dynamics

LOOSEST, TIGHTEST = 0.03, 1e-6
"""Part of the error tolerance that the iteration may leave.  0.03 in place of IDA's own 0.33 saves a quarter of the
steps; tighter than needed, it would fail in poses where the constraints are nearly dependent."""
SOFT = 1.5e4
"""1/s^2, the square of a rate, times the part that may be left: what remains in a position makes a force through the
stiffness, and the force a velocity, which has to stay below the tolerance too.  Measured on a bushing of 1e9 N/m on
1 kg: 5 000 steps with 0.33, 200 with this."""
NUMBERS_END = 1e-13
"""Least part of a coordinate that the iteration can settle, through iteration matrices as ill-conditioned as they get."""


UNBALANCED = 0.3
"""Part of the largest force, relative to rtol, by which the forces on a body may be out of balance between steps.  Forces of two bushings beside
each other are off by several times that: of a car on bushings of 1e9 N/m by 2 and 5 `rtol` (1e-3, 1e-4), with 1 by 7 and 8."""
AMPLIFIED = 400.0
"""Force that an error between steps makes, relative to the force that the same error makes by its rates in a step, beyond which
it shows.  Measured on a bar on a bushing and on the half car: with 8 accelerations between steps are no better than forces, with
1.6e4 forces are off by a tenth of their size."""


class Stiffness(NamedTuple):
    """Bounds on what forces do to the motion near a state.

    Attributes
    ----------
    of_positions : float
        The largest row sum of M^-1/2 df/dq M^-1/2, 1/s^2.
    of_velocities : float
        The same of M^-1 df/du, 1/s.
    """

    of_positions: float
    of_velocities: float

    @property
    def fastest(self) -> float:
        """The square of the fastest rate, 1/s^2."""
        return max(self.of_positions, self.of_velocities * self.of_velocities)  # infinite where a power would raise

    @property
    def allowed_residual(self) -> float:
        """The part of the error tolerance that makes no force which counts."""
        return SOFT / self.fastest if self.fastest > 0 else np.inf

    @property
    def long_step(self) -> float:
        """The step, s, beyond which states within it have to be brought back to the balance of forces; may be infinite."""
        by_position = math.sqrt(AMPLIFIED / self.of_positions) if self.of_positions > 0 else math.inf
        by_velocity = AMPLIFIED / self.of_velocities if self.of_velocities > 0 else math.inf
        return min(by_position, by_velocity)


def stiffness_at(dynamics: Dynamics, t: float) -> Stiffness:
    """That of the state at hand."""
    state = dynamics.state
    state.evaluate("tangent", t)
    sums = row_sums_of(dynamics)
    with np.errstate(over="ignore"):  # of a body of next to no mass: infinite
        values = state.values["tangent"]
        return Stiffness(*(of_term.largest(values) for of_term in sums))


def row_sums_of(dynamics: Dynamics) -> tuple[RowSums, RowSums]:
    """Those of the derivatives of accelerations by positions and by velocities."""
    return dynamics.kept("row sums", None, lambda: _row_sums(dynamics.system))


def _row_sums(system: System) -> tuple[RowSums, RowSums]:
    f_q, f_u = system.term("tangent", "f_q"), system.term("tangent", "f_u")
    return row_sums(f_q, system.mass, system.mass_by_coordinate), row_sums(f_u, system.mass, system.mass)


def newton_tolerance(stiffness: Stiffness, settings: RunSettings) -> float:
    """The part of the error tolerance that Newton's iteration may leave."""
    return max(min(LOOSEST, stiffness.allowed_residual), TIGHTEST, NUMBERS_END / settings.rtol)


class RowSums(NamedTuple):
    """Sums of magnitudes in the rows of M^-1/2 A M^-1/2, A being a term.

    The largest bounds the same eigenvalues as that of M^-1 A, and does not depend on the units of lengths and angles.  On a car it was
    2 times the square of the fastest rate, where that of M^-1 A was 160 times.  Columns of coordinates without a mass stay as they are in M^-1 A.

    Attributes
    ----------
    source, row : ndarrays of int
        Where the entries stand among the values of their set, and their rows.
    scales : ndarray
        What each entry is divided by.
    n : int
        Number of rows.
    """

    source: np.ndarray
    row: np.ndarray
    scales: np.ndarray
    n: int

    def largest(self, values: np.ndarray) -> float:
        """The largest sum, from the values of the term's set."""
        sums = np.bincount(self.row, np.abs(values[self.source]) / self.scales, minlength=self.n)
        return float(sums.max()) if self.n else 0.0


def row_sums(term: Term, mass: np.ndarray, of_columns: np.ndarray) -> RowSums:
    """Those of a term, by the masses of its rows and its columns."""
    of_rows, of_term = mass[term.row], of_columns[term.column]
    scales = np.sqrt(of_rows) * np.sqrt(np.where(of_term > 0, of_term, of_rows))
    return RowSums(term.source, term.row, scales, len(mass))

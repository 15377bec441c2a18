"""The equations of one loop, without units, and its assembly where they are redundant."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..compile.state import State
from .loops import Loop
from .sparse_matrix import SparseMatrix

CLOSED = 1e-11
"""Largest violation, relative to the loop's size, of a pose that counts as assembled."""
AGREES = 1e-6
"""The same, where equations are redundant and given by some digits only."""
MOST_STEPS = 40
"""Steps of an assembly; where equations agree a few are enough."""
LONGEST_STEP = 1.0
"""Longest move of one step (arms, rad), so that assembly stays near the pose described."""
STATIONARY = 1e-9
"""Slope of |C|, relative to itself, below which equations that disagree come no closer to holding."""
LEAST_DAMPING = 1e-13
"""Keeps C_q C_q^T regular where equations are redundant; far below the squares of singular values that count."""
LEAST_NORM = 1e-9
"""A row is scaled as if it were at least this part of the others: one that vanishes must not be blown up."""


class Pose(NamedTuple):
    """A loop at an instant and pose, everything in the loop's own rows and columns and without units.

    Attributes
    ----------
    q : ndarray
        Coordinates of the loop's bodies, m and rad (quaternions).
    t : float
        s.
    gap : float
        Largest violation of the positions.
    C : ndarray, shape (n,)
        Violations.
    C_q, J : SparseMatrix, shape (n, velocities)
        Derivatives of the positions by moves, and of the velocity level.
    rates : ndarray, shape (n,)
        J u + C_t at u = 0, 1/s.
    """

    q: np.ndarray
    t: float
    gap: float
    C: np.ndarray
    C_q: SparseMatrix
    J: SparseMatrix
    rates: np.ndarray


class LoopEquations:
    """C, J and C_t of a loop at any pose: lengths in units of its joints' arms, each row of J of length one.

    Parameters
    ----------
    loop : Loop
    state : State
        Working memory; its pose is where rows are scaled.
    t : float
        s.

    Attributes
    ----------
    length : float
        Root mean square arm of the joints, m: velocities count in it, so that units of length do not matter.
    row_scale : ndarray, shape (n,)
        What each equation is multiplied by; so lam = row_scale * w for a null vector w of the scaled J^T.
    timed : ndarray of bool, shape (n,)
        Which equations have time in them.
    """

    def __init__(self, loop: Loop, state: State, t: float) -> None:
        self.loop, self.state = loop, state
        system = state.system
        self._row_at, self._column_at = np.full(system.n_c, -1), np.full(system.n_u, -1)
        self._row_at[loop.rows] = np.arange(len(loop.rows))
        self._column_at[loop.columns] = np.arange(len(loop.columns))
        self._vectors = {name: self._places(name) for name in ("C", "V")}
        self._pattern = self._pattern_of_J()
        self._holonomic = system.holonomic[loop.rows]
        self.timed = system.timed[loop.rows]
        state.evaluate("motion", t)
        J = self._J()
        turning = system.per_velocity(0.0, 1.0)[loop.columns] > 0
        self.length = _root_mean_square_arm(J, turning, system.size)
        self._column_scale = np.where(turning, 1.0, self.length)
        self.row_scale = np.ones(len(loop.rows))
        self.scale_rows([J.scaled(self.row_scale, self._column_scale)])

    def scale_rows(self, matrices: list[SparseMatrix]) -> None:
        """Scale rows so that the longest form that each takes in matrices scaled so far has length one."""
        norms = np.max([J.norms() for J in matrices], axis=0)
        self.row_scale /= np.maximum(norms, LEAST_NORM * np.median(norms) or 1.0)

    def pose(self, q: np.ndarray, t: float) -> Pose:
        """The equations at given coordinates of the loop's bodies."""
        state, rows = self.state, self.row_scale
        state.q[self.loop.coordinates] = q
        state.u[self.loop.columns] = 0.0
        state.evaluate("motion", t)
        C = rows * self._vector("C")
        J = self._J().scaled(rows, self._column_scale)
        C_q = J if self._holonomic.all() else J.scaled(1.0 * self._holonomic, np.ones(J.shape[1]))
        return Pose(q, t, float(np.abs(C).max()), C, C_q, J, rows * self._vector("V"))

    def moved(self, q: np.ndarray, move: np.ndarray) -> np.ndarray:
        """Coordinates after a move without units."""
        return self.state.system.of_body.moved(q, self._column_scale * move)

    def velocities(self, rates: np.ndarray) -> np.ndarray:
        """Velocities of the loop's bodies from such without units of length."""
        return self._column_scale * rates

    def distance(self, a: Pose, b: Pose) -> float:
        """Length of the move between two poses, without units."""
        return float(np.linalg.norm(self.state.system.of_body.move(a.q, b.q) / self._column_scale))

    def assembled(self, q: np.ndarray, t: float, kept: np.ndarray | None = None) -> Pose:
        """The pose nearby where the equations hold, or come closest to holding.

        Levenberg and Marquardt's steps with the damping |C|^2 (Yamashita and Fukushima, Computing Suppl. 15, 2001),
        which converge quadratically to solutions that are not isolated, whatever the rank of C_q there.

        Parameters
        ----------
        kept : ndarray of bool, optional
            The rows to satisfy; all by default.
        """
        rows = np.ones(len(self.loop.rows), dtype=bool) if kept is None else kept
        pose = self.pose(q, t)
        closed = False  # one step more once closed, not more: where C_q is singular they would creep towards that pose
        for _ in range(MOST_STEPS):
            C, C_q = pose.C[rows], pose.C_q if kept is None else pose.C_q.of_rows(rows)
            if closed or not C_q.finite or not np.any(C):
                break
            closed = bool(np.abs(C).max() < CLOSED)
            slope = C_q.transposed_times(C)
            if not closed and np.linalg.norm(slope) < STATIONARY * np.linalg.norm(C):
                break
            damping = max(float(C @ C), LEAST_DAMPING)
            step = -C_q.transposed_times(C_q.solved_gram(damping, C))
            length = float(np.linalg.norm(step))
            pose = self.pose(self.moved(pose.q, step * min(1.0, LONGEST_STEP / max(length, 1e-300))), t)
            if length < 1e-14 * len(C):
                break
        self.state.count_anew(t)
        return pose

    def _places(self, name: str) -> tuple[np.ndarray, ...]:
        """Source, row and column of a term's entries in this loop."""
        term = self.state.system.term("motion", name)
        inside = self._row_at[term.row] >= 0
        return term.source[inside], self._row_at[term.row[inside]], self._column_at[term.column[inside]]

    def _pattern_of_J(self) -> tuple[np.ndarray, np.ndarray, SparseMatrix]:
        """Sources of the entries of J, the place to which each adds, and the places."""
        source, row, column = self._places("J")
        width = len(self.loop.columns)
        places, add_to = np.unique(row * width + column, return_inverse=True)
        shape = (len(self.loop.rows), width)
        return source, add_to, SparseMatrix(places // width, places % width, np.zeros(len(places)), shape)

    def _J(self) -> SparseMatrix:
        source, add_to, entries = self._pattern
        return replace(entries, value=np.bincount(add_to, self.state.values["motion"][source], len(entries.value)))

    def _vector(self, name: str) -> np.ndarray:
        source, row, _ = self._vectors[name]
        result = np.zeros(len(self.loop.rows))
        result[row] = self.state.values["motion"][source]
        return result


def _root_mean_square_arm(J: SparseMatrix, turning: np.ndarray, size: float) -> float:
    """Of the rows that hold points: the part in angular velocities (`turning`) over that in velocities, m."""
    along, about = (J.of_columns(part).norms() for part in (~turning, turning))
    of_points = along * size > 1e-6 * about
    arms = about[of_points] / along[of_points]
    return float(np.sqrt(np.mean(arms**2))) if np.any(arms > 0) else size

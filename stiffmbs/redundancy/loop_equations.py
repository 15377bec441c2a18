"""Dimensionless equations of one loop, and its assembly with redundant equations."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..compile.state import State
from .loops import Loop
from .parameters import REDUNDANCY
from .sparse_matrix import SparseMatrix


class Pose(NamedTuple):
    """Dimensionless equations of a loop at a time and pose, in the loop's rows and columns.

    - `q`: coordinates of the loop's bodies, m and rad (quaternions).
    - `t`: s.
    - `gap`: largest position violation.
    - `C` of shape (n,): violations.
    - `C_q`, `J` of shape (n, velocities): derivatives of the positions by displacements, and of the velocity level.
    - `rates` of shape (n,): J u + C_t at u = 0, 1/s.
    """

    q: np.ndarray
    t: float
    gap: float
    C: np.ndarray
    C_q: SparseMatrix
    J: SparseMatrix
    rates: np.ndarray


class LoopEquations:
    """C, J and C_t of a loop at any pose: lengths in units of its joints' arms, rows of J normalised.

    `state`: working memory; rows are scaled at its pose. `t`: s. `length`: root mean square arm of the joints, m, as
    the unit of length. `row_scale` of shape (n,): factor of each equation; lam = row_scale * w for a null vector w of
    the scaled J^T. `timed` of shape (n,): mask of the equations that contain time.
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
        """Scale rows so that the largest norm of each in the given scaled matrices is one."""
        norms = np.max([J.norms() for J in matrices], axis=0)
        middle = np.sort(norms)[(len(norms) - 1) // 2 : len(norms) // 2 + 1].mean()  # np.median loads numpy.ma
        self.row_scale /= np.maximum(norms, REDUNDANCY.rounding * middle or 1.0)

    def pose(self, q: np.ndarray, t: float) -> Pose:
        """Return the equations at given coordinates of the loop's bodies."""
        state, rows = self.state, self.row_scale
        state.q[self.loop.coordinates] = q
        state.u[self.loop.columns] = 0.0
        state.evaluate("motion", t)
        C = rows * self._vector("C")
        J = self._J().scaled(rows, self._column_scale)
        C_q = J if self._holonomic.all() else J.scaled(1.0 * self._holonomic, np.ones(J.shape[1]))
        return Pose(q, t, float(np.abs(C).max()), C, C_q, J, rows * self._vector("V"))

    def moved(self, q: np.ndarray, move: np.ndarray) -> np.ndarray:
        """Return coordinates after a dimensionless displacement."""
        return self.state.system.of_body.moved(q, self._column_scale * move)

    def velocities(self, rates: np.ndarray) -> np.ndarray:
        """Return velocities of the loop's bodies from dimensionless ones."""
        return self._column_scale * rates

    def distance(self, a: Pose, b: Pose) -> float:
        """Return the dimensionless distance of two poses."""
        return float(np.linalg.norm(self.state.system.of_body.move(a.q, b.q) / self._column_scale))

    def assembled(self, q: np.ndarray, t: float, kept: np.ndarray | None = None) -> Pose:
        """Return the nearest pose at which the equations hold, or come closest to holding.

        Levenberg-Marquardt steps with the damping |C|^2 (Yamashita and Fukushima, Computing Suppl. 15, 2001) converge
        quadratically to non-isolated solutions for any rank of C_q. `kept`: mask of the rows to satisfy; all by
        default.
        """
        rows = np.ones(len(self.loop.rows), dtype=bool) if kept is None else kept
        pose = self.pose(q, t)
        closed = False  # one more step once closed; further ones would drift towards a pose with singular C_q
        for _ in range(REDUNDANCY.most_steps):
            C, C_q = pose.C[rows], pose.C_q if kept is None else pose.C_q.of_rows(rows)
            if closed or not C_q.finite or not np.any(C):
                break
            closed = bool(np.abs(C).max() < REDUNDANCY.closed)
            slope = C_q.transposed_times(C)
            if not closed and np.linalg.norm(slope) < REDUNDANCY.rounding * np.linalg.norm(C):
                break
            damping = max(float(C @ C), REDUNDANCY.least_damping)
            step = -C_q.transposed_times(C_q.solved_gram(damping, C))
            length = float(np.linalg.norm(step))
            pose = self.pose(self.moved(pose.q, step * min(1.0, REDUNDANCY.longest_step / max(length, 1e-300))), t)
            if length < 1e-14 * len(C):
                break
        self.state.restart_counters(t)
        return pose

    def _places(self, name: str) -> tuple[np.ndarray, ...]:
        """Return source, row and column of a term's entries in this loop."""
        term = self.state.system.term("motion", name)
        inside = self._row_at[term.row] >= 0
        return term.source[inside], self._row_at[term.row[inside]], self._column_at[term.column[inside]]

    def _pattern_of_J(self) -> tuple[np.ndarray, np.ndarray, SparseMatrix]:
        """Return the sources of the entries of J, the place to which each adds, and the places."""
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
    """Return the arm in m from rows that hold points: the norm in angular velocities over that in velocities."""
    along, about = (J.of_columns(part).norms() for part in (~turning, turning))
    of_points = along * size > 1e-6 * about
    arms = about[of_points] / along[of_points]
    return float(np.sqrt(np.mean(arms**2))) if np.any(arms > 0) else size

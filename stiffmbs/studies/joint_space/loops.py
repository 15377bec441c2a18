"""Loops of a mechanism: coordinates that follow from independent ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ...compile.bodies import SPACE
from ...compile.quaternions import CONJUGATE, times
from ...dynamics.joint_tree import Frame, JointTree
from ...dynamics.native.parameters import CONSISTENCY
from ...errors import InputError, SolverError

SINGULAR: Final = 1e-5
"""Smallest singular value of the equations of the dependent rates, relative to the largest, below which a pose is singular. Near a dead
point, coordinates are known to the root of the tolerance of positions, 1e-6."""
WORTH_CHOOSING: Final = 1e-2
"""Part of a rate outside those that follow already, from which on it may follow, too."""
CLOSED: Final = 1e-14
"""Gap of a loop at which the iteration ends, sizes of the mechanism."""

SAME_SENSE: Final = 0.1
"""Smallest real part of the eigenvalues of J(q1)^-1 J(q2) at two poses of one motion."""
SHARPEST: Final = 0.5
"""Largest change of the direction of a motion between these poses."""


@dataclass(frozen=True)
class Passed:
    """Pose on a motion: coordinates of the tree, derivatives of the loops by dependent rates, and direction of the tree's rates."""

    q: np.ndarray
    equations: np.ndarray
    direction: np.ndarray

    def leads_to(self, other: Passed) -> bool:
        """Return True if the loops are closed in the same way at another pose.

        Beyond a singular pose, as by the other elbow of an arm, J(q1)^-1 J(q2) has a negative eigenvalue. Where two motions
        cross, one of them turns sharply instead.
        """
        if np.linalg.norm(other.direction - self.direction) > SHARPEST:
            return False
        change = np.linalg.lstsq(self.equations, other.equations, rcond=None)[0]
        return bool(np.linalg.eigvals(change).real.min(initial=1.0) > SAME_SENSE)


class Loops:
    """Dependent rates of a spanning tree.

    `names`: of the tree's rates. `order`: rates in the order in which they become dependent if they may. `count`: number of
    dependent rates. `unit`: size of each rate. The tree is at a pose on the constraints. Raises InputError if the pose is singular.
    """

    def __init__(
        self, tree: JointTree, t: float, names: tuple[str, ...], order: list[int], count: int, unit: np.ndarray
    ) -> None:
        self._tree, self._t, self._names = tree, t, names
        self._unit = unit
        self.dependent = self._chosen(order, count)
        self.independent = np.setdiff1d(np.arange(len(names)), self.dependent)

    def _chosen(self, order: list[int], count: int) -> np.ndarray:
        if not count:
            return np.zeros(0, dtype=int)
        self._tree.closure(self._t)
        columns = self._tree.J * self._unit
        scale = np.linalg.norm(columns, 2)
        basis = np.zeros((len(columns), 0))
        found: list[int] = []
        for least in (WORTH_CHOOSING, SINGULAR):
            for k in order:
                if len(found) == count or k in found:
                    continue
                rest = columns[:, k] - basis @ (basis.T @ columns[:, k])
                rest -= basis @ (basis.T @ rest)
                if np.linalg.norm(rest) > least * scale:
                    found.append(k)
                    basis = np.column_stack([basis, rest / np.linalg.norm(rest)])
        if len(found) < count:
            raise InputError(
                "joint_space: the start is a singular pose, in which the loops leave more motions free than elsewhere; "
                "start from another pose"
            )
        return np.array(sorted(found), dtype=int)

    def map(self) -> np.ndarray:
        """Return D with the tree's rates D v for independent rates v; the tree has J of its pose."""
        found = np.zeros((len(self._names), len(self.independent)))
        found[self.independent, np.arange(len(self.independent))] = 1.0
        found[self.dependent] = -self.solved(self._tree.J[:, self.independent])
        return found

    def solved(self, right: np.ndarray) -> np.ndarray:
        """Return dependent rates x with J_d x = right, consistent where equations are redundant.

        Raises SolverError at a singular pose.
        """
        unit = self._unit[self.dependent]
        left, values, across = np.linalg.svd(self._tree.J[:, self.dependent] * unit, full_matrices=False)
        if not values[-1] > SINGULAR * values[0]:
            raise SolverError(
                f"the coordinates {', '.join(self._names[k] for k in self.independent)} do not determine the motion in this "
                "pose, such as a dead point; choose other coordinates by `independent`, or another pose"
            )
        solution = across.T @ ((left.T @ right).T / values).T
        found: np.ndarray = (solution.T * unit).T
        return found

    def along(self, way: np.ndarray) -> Passed:
        """Return the pose of the tree's J on a motion with the independent rates `way`."""
        rates = self.map() @ way / self._unit
        return Passed(
            self._tree.q.copy(),
            self._tree.J[:, self.dependent] * self._unit[self.dependent],
            rates / (np.linalg.norm(rates) or 1.0),
        )

    def close(self) -> bool:
        """Move dependent coordinates until the loops are closed; return False if they are not."""
        tree, size = self._tree, self._tree.state.system.size or 1.0
        before = np.inf
        for _ in range(CONSISTENCY.most_assembly_moves):
            tree.closure(self._t)
            gap = float(np.abs(tree.C).max(initial=0.0))
            if gap <= CLOSED * size or (gap <= CONSISTENCY.position_tolerance and gap > 0.5 * before):
                return True
            if not np.isfinite(gap):
                return False
            before = gap
            move = np.zeros(len(self._names))
            move[self.dependent] = -self.solved(tree.C)
            longest = float(np.abs(move / self._unit).max(initial=0.0))
            move_tree(tree, move / max(1.0, 2.0 * longest))
        return False


def move_tree(tree: JointTree, move: np.ndarray) -> None:
    """Move the coordinates of a tree by rates times time; quaternions remain normalised."""
    for frame in tree.tree.frames:
        tree.q[frame.at_q : frame.at_q + frame.widths[0]] = moved(frame, tree.q, move)


def difference(frame: Frame, first: np.ndarray, goal: np.ndarray) -> np.ndarray:
    """Return the rates of one frame from some coordinates of the tree to others."""
    there = slice(frame.at_q, frame.at_q + frame.widths[0])
    change = goal[there] - first[there]
    if frame.screw is not None:
        return change
    return np.concatenate([change[:3], 2.0 * times(CONJUGATE * first[there][3:], goal[there][3:])[1:]])


def moved(frame: Frame, q: np.ndarray, move: np.ndarray) -> np.ndarray:
    """Return the coordinates of one frame after a move."""
    own = q[frame.at_q : frame.at_q + frame.widths[0]]
    step = move[frame.at_v : frame.at_v + frame.widths[1]]
    return own + step if frame.screw is not None else SPACE.moved(own, step)

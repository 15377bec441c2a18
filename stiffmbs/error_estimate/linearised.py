"""Equations of motion linearised at many states, in the tangent space of joints and drives.

Variations e = B a of a state, B of shape (3 blocks, n), are tangent to the constraints; their rates are e' = R a. Both are
differences of projected states and their accelerations, evaluated by the kernels that the output rows of a run use.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from .coordinates import as_rows, displaced, functions_of_changes, pose_changes, width, with_rates
from .evaluated import Evaluated, evaluated
from .parameters import ESTIMATE


@dataclass(frozen=True)
class Linearised:
    """Tangent spaces of `count` states; `basis` B and `rates` R of shape (count, full, n), `left` L of shape (count, n, full).

    L B is not singular: a = (L B)^-1 L e are the coordinates of a tangent variation e.
    """

    basis: np.ndarray
    rates: np.ndarray
    left: np.ndarray

    @property
    def n(self) -> int:
        """Dimension of the tangent space."""
        return self.basis.shape[2]

    def at(self, chosen: slice | np.ndarray) -> Linearised:
        """Return the tangent spaces at some of the states."""
        return Linearised(self.basis[chosen], self.rates[chosen], self.left[chosen])


def linearised(dynamics: Dynamics, at: Evaluated, reach: float) -> Linearised:
    """Return the tangent spaces at evaluated states, and the rates of their variations.

    `reach`: longest time over which an error is transported with the same rates, s.
    """
    system = dynamics.system
    numbers = (system.n_q + 2 * system.n_u) * (2 * system.n_u + system.n_q - system.n_pose)
    count = max(1, ESTIMATE.numbers_at_once // max(numbers, 1))
    parts = [_linearised(dynamics, at.at(slice(k, k + count)), reach) for k in range(0, len(at.t), count)]
    if len(parts) == 1:
        return parts[0]
    return Linearised(*(np.concatenate([getattr(part, name) for part in parts]) for name in ("basis", "rates", "left")))


def _linearised(dynamics: Dynamics, at: Evaluated, reach: float) -> Linearised:
    """Return the tangent spaces at a few states.

    A displacement that stretches a stiff spring turns its force too. Where such an error of the differences would accelerate
    others, they are repeated along the directions of decreasing rates, of which most do not stretch it.
    """
    moves, left = _moves(dynamics, at)
    basis, rates = _differences(dynamics, at, moves)
    of_moves = left @ rates
    errors = ESTIMATE.difference * reach**2 * np.linalg.norm(of_moves, axis=(1, 2))
    stiff = np.flatnonzero((errors > ESTIMATE.large) & np.isfinite(errors))
    if len(stiff):
        of_stiff = of_moves[stiff]
        directions = np.linalg.eigh(of_stiff.transpose(0, 2, 1) @ of_stiff)[1][:, :, ::-1].transpose(0, 2, 1)
        basis[stiff], rates[stiff] = _differences(dynamics, at.at(stiff), directions @ moves[stiff])
    return Linearised(basis, rates, left)


def _moves(dynamics: Dynamics, at: Evaluated) -> tuple[np.ndarray, np.ndarray]:
    """Return changes (dq, du, ds) of states along their tangent spaces, shape (count, n, full), and the matrices `left`."""
    system, count = dynamics.system, len(at.t)
    n_u, trailing = system.n_u, with_rates(system)
    scale = system.per_velocity(system.size, 1.0)
    jacobian = _velocity_constraints(dynamics, at) * scale
    free = _null_spaces(jacobian[:, system.active])
    holonomic = system.active & system.holonomic
    poses = free if holonomic.sum() == system.active.sum() else _null_spaces(jacobian[:, holonomic])
    n_a, n_b, n_s, n_pose, n_v = poses.shape[2], free.shape[2], len(trailing), system.n_pose, system.n_pose + n_u
    moves, left = (np.zeros((count, n_a + n_b + n_s, width(system))) for _ in range(2))
    along, along_v = poses.transpose(0, 2, 1), free.transpose(0, 2, 1)
    left[:, :n_a, :n_pose] = functions_of_changes(system, at.q, along / scale)
    left[:, n_a : n_a + n_b, n_pose:n_v] = along_v / scale
    left[:, n_a + n_b :, n_v:] = np.eye(n_s)
    speed = max(1.0, float(np.abs(at.u / scale).max(initial=0.0)))
    moves[:, :n_a, :n_pose] = pose_changes(system, at.q, along * scale)
    moves[:, n_a : n_a + n_b, n_pose:n_v] = speed * along_v * scale
    of_states = np.maximum(1.0, np.abs(at.q[:, trailing]).max(axis=0, initial=0.0))
    moves[:, n_a + n_b :, n_v:] = np.diag(of_states)
    return moves, left


def _differences(dynamics: Dynamics, at: Evaluated, moves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the variations of states by small parts of given moves, and their rates, shape (count, full, n)."""
    system, part = dynamics.system, ESTIMATE.difference
    count, n, full = moves.shape
    if not n:
        return np.zeros((count, full, n)), np.zeros((count, full, n))
    origins = at.at(np.repeat(np.arange(count), n))
    moved = displaced(system, origins.q, origins.u, part * moves.reshape(count * n, full))
    there = evaluated(dynamics, origins.t, *moved)
    changes = as_rows(system, there.q - origins.q, there.u - origins.u), rate_changes(system, origins, there)
    basis, rates = (each.reshape(count, n, full).transpose(0, 2, 1) / part for each in changes)
    return basis, rates


def rate_changes(system: System, at: Evaluated, there: Evaluated) -> np.ndarray:
    """Return the changes of the rates from states to others nearby, as rows (dq, du, ds)."""
    return as_rows(system, there.q_rates - at.q_rates, there.acceleration - at.acceleration)


def nearly_singular(dynamics: Dynamics, at: Evaluated) -> np.ndarray:
    """Return a mask of the states so near to a singular pose that displacements on the constraints are not linear there.

    At a distance d, as a part of the usual one, their nonlinearity is `ESTIMATE.difference` / d^2.
    """
    system = dynamics.system
    scale = system.per_velocity(system.size, 1.0)
    matrices = (_velocity_constraints(dynamics, at) * scale)[:, system.active]
    if not 0 < matrices.shape[1] < matrices.shape[2]:
        return np.zeros(len(at.t), dtype=bool)
    sizes = np.linalg.norm(matrices, axis=2, keepdims=True)
    r = np.linalg.qr((matrices / np.where(sizes > 0, sizes, 1.0)).transpose(0, 2, 1), mode="r")
    least = np.abs(np.diagonal(r, axis1=1, axis2=2)).min(axis=1)
    return np.asarray(ESTIMATE.difference > ESTIMATE.large * (least / least.max()) ** 2)


def _velocity_constraints(dynamics: Dynamics, at: Evaluated) -> np.ndarray:
    """Return J of many states, shape (count, n_c, n_u)."""
    system, state = dynamics.system, dynamics.state
    term = system.term("motion", "J")
    values = np.empty((len(at.t), len(term.source)))
    for k in range(len(at.t) if len(term.source) else 0):
        state.q[:], state.u[:] = at.q[k], at.u[k]
        state.evaluate("motion", float(at.t[k]))
        values[k] = state.values["motion"][term.source]
    found = np.zeros((len(at.t), system.n_c, system.n_u))
    for entry, (row, column) in enumerate(zip(term.row.tolist(), term.column.tolist(), strict=True)):
        found[:, row, column] += values[:, entry]
    return found


def _null_spaces(matrices: np.ndarray) -> np.ndarray:
    """Return orthonormal bases of the null spaces of matrices of full rank, shape (count, n, n - m)."""
    count, m, n = matrices.shape
    if not m:
        return np.broadcast_to(np.eye(n), (count, n, n))
    if m >= n:
        return np.zeros((count, n, 0))
    sizes = np.linalg.norm(matrices, axis=2, keepdims=True)
    q = np.linalg.qr((matrices / np.where(sizes > 0, sizes, 1.0)).transpose(0, 2, 1), mode="complete")[0]
    return q[:, :, m:]

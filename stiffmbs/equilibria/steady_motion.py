"""Steady motion of all bodies as one rigid body, some of which also spin about their axes of symmetry.

With the velocity V, the angular velocity W and a point c of its axis, a centre of mass at r has

  v = V + W x (r - c),    v' = W x v,

and a spinning body has the angular velocity W + s e, with the rate (W + s e)' = W x s e in its own axes.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated
from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from .matrices import Matrix, block_diagonal, dense, matrix_of, zeros
from .parameters import EQUILIBRIA


@dataclass(frozen=True)
class SteadyMotion:
    """Steady motion of a system.

    Attributes
    ----------
    velocity, about : ndarrays, shape (dimensions,)
        V, m/s, and c, m.
    rotation : ndarray, shape (1,) or (3,)
        W, rad/s.
    spinning : ndarray of int
        Numbers of the angular velocities that differ from W.
    spins : ndarray
        Their differences, unless rolling constraints determine them, rad/s.
    speed_is_found : bool
        Whether forces determine the speed along V.
    found : ndarray of int
        Positions in `spinning` of the spins that forces determine.
    upright : ndarray, shape (1,) or (3,), optional
        Direction of a rotation whose rate forces determine; None for a given rotation.
    """

    velocity: np.ndarray
    rotation: np.ndarray
    about: np.ndarray
    spinning: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    spins: np.ndarray = field(default_factory=lambda: np.zeros(0))
    speed_is_found: bool = False
    found: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    upright: np.ndarray | None = None

    @property
    def is_rest(self) -> bool:
        """True if all velocities are zero."""
        return not (np.any(self.velocity) or np.any(self.rotation) or np.any(self.spins))

    def changes_with_pose(self, system: System) -> bool:
        """Return True if velocities or accelerations depend on the pose: the bodies rotate, or rolling makes them spin."""
        rolls = len(self.spinning) > 0 and not np.all(system.holonomic)
        return not self.is_rest and (rolls or bool(np.any(self.rotation)))

    @property
    def n_found(self) -> int:
        """Number of unknown speeds: that along V, the rate of rotation, and the spins of `found`."""
        return self._first_spin + len(self.found)

    @property
    def _first_spin(self) -> int:
        return int(self.speed_is_found) + int(self.upright is not None)

    def faster(self, changes: np.ndarray) -> SteadyMotion:
        """Return the motion with changed unknown speeds: that along V, the rate of rotation, spins."""
        along, rate, spins = np.split(changes, [int(self.speed_is_found), self._first_spin])
        velocity = self.velocity + along.sum() * self._ahead()
        rotation = self.rotation if self.upright is None else self.rotation + rate.sum() * self.upright
        changed = self.spins.copy()
        changed[self.found] += spins
        return replace(self, velocity=velocity, rotation=rotation, spins=changed)

    def speed_sizes(self, size: float) -> np.ndarray:
        """Return the magnitudes of the unknown speeds, in a mechanism of a size, m."""
        speed = float(np.linalg.norm(self.velocity))
        spins = np.maximum(np.abs(self.spins[self.found]), speed / size)
        turns = np.full(int(self.upright is not None), speed / size)
        return np.concatenate([np.full(int(self.speed_is_found), speed), turns, spins])

    def by_speeds(self, dynamics: Dynamics) -> np.ndarray:
        """Return derivatives of the velocities by the unknown speeds, shape (n_u, speeds)."""
        of_body, n_u, first = dynamics.system.of_body, dynamics.system.n_u, self._first_spin
        by = np.zeros((n_u, self.n_found))
        by_body = by.reshape(-1, of_body.n_u, self.n_found)
        if self.speed_is_found:
            by_body[:, : of_body.linear, 0] = self._ahead()
        if self.upright is not None:
            by[:, first - 1] = replace(self, velocity=0 * self.velocity, rotation=self.upright).carried(dynamics)
        for k in range(first):
            by[self.spinning, k] += self._spins_with(dynamics, by[:, k])
        by[self.spinning[self.found], first + np.arange(len(self.found))] = 1.0
        return by

    def accelerated_by_speeds(self, dynamics: Dynamics, by: np.ndarray) -> np.ndarray:
        """Return derivatives of the accelerations by the unknown speeds, given those of the velocities."""
        found = self.by_move(dynamics) @ by
        if self.upright is not None:
            turned = replace(self, rotation=self.upright)
            found[:, self._first_spin - 1] += turned.by_move(dynamics) @ dynamics.state.u
        return found

    def replaced(self, dynamics: Dynamics, by: np.ndarray) -> np.ndarray:
        """Return the displacement that each unknown speed replaces; for a rotation one to the side, as of a car."""
        if self.upright is None:
            return by
        of_body, found = dynamics.system.of_body, by.copy()
        aside = found.reshape(-1, of_body.n_u, by.shape[1])[:, :, self._first_spin - 1]
        aside[:] = 0.0
        aside[:, : of_body.linear] = _cross(self.upright, self._ahead())
        return found

    def _spins_with(self, dynamics: Dynamics, by_speed: np.ndarray) -> np.ndarray:
        """Return derivatives of the spins that rolling determines by the speed."""
        rows, across = self._rolling(dynamics)
        if not across.size:
            return np.zeros(len(self.spinning))
        found: np.ndarray = -np.linalg.lstsq(across, rows @ by_speed, rcond=EQUILIBRIA.no_effect)[0]
        return found

    def _ahead(self) -> np.ndarray:
        direction: np.ndarray = self.velocity / np.linalg.norm(self.velocity)
        return direction

    def fixed_by_rolling(self, dynamics: Dynamics) -> np.ndarray:
        """Return a mask of the spins that a rolling constraint determines."""
        _, across = self._rolling(dynamics)
        return np.asarray(np.linalg.norm(across, axis=0) > EQUILIBRIA.no_effect)

    def carried(self, dynamics: Dynamics) -> np.ndarray:
        """Return the velocities of all bodies as parts of one rigid body, at the current pose."""
        places = self._places(dynamics)
        straight = self.velocity + _cross(self.rotation, places - self.about)
        return np.concatenate([straight, self._own(dynamics)], axis=1).ravel()

    def put(self, dynamics: Dynamics, t: float) -> None:
        """Set the velocities of the current pose."""
        state = dynamics.state
        state.u[:] = 0.0 if self.is_rest else self.carried(dynamics)
        if len(self.spinning):
            state.evaluate("motion", t)
            rolls = self.fixed_by_rolling(dynamics)
            spins = np.where(rolls, 0.0, self.spins)
            if rolls.any():
                _, across = self._rolling(dynamics)
                missing = state.vector("motion", "V")[~dynamics.system.holonomic] + across @ spins
                spins[rolls] -= np.linalg.lstsq(across[:, rolls], missing, rcond=EQUILIBRIA.no_effect)[0]
            state.u[self.spinning] += spins

    def turning(self, system: System) -> Matrix:
        """Return W x for displacements and rotations of all bodies in ground axes, shape (n_u, n_u)."""
        turn = _matrix(self.rotation)
        of_body = [turn, np.zeros((1, 1))] if system.of_body.linear == 2 else [turn, turn]
        return block_diagonal(system, of_body * len(system.bodies))

    def acceleration(self, dynamics: Dynamics) -> np.ndarray:
        """Return u' of the current pose and velocities."""
        system, u = dynamics.system, dynamics.state.u
        found = np.zeros((len(system.bodies), system.of_body.n_u))
        if self.is_rest:
            return found.ravel()
        linear = system.of_body.linear
        rates = u.reshape(found.shape)
        found[:, :linear] = _cross(self.rotation, rates[:, :linear])
        if linear == 3:
            own = self._own(dynamics)
            found[:, linear:] = np.cross(own, rates[:, linear:] - own)
        return found.ravel()

    def derivatives(self, dynamics: Dynamics, t: float, rates: Matrix) -> tuple[Matrix, Matrix]:
        """Return derivatives of velocities and accelerations by displacements, shapes (n_u, n_u), if there are any.

        `rates` of shape (n_q, n_u): Z of q' = Z u.
        """
        system, u = dynamics.system, dynamics.state.u
        turning, by_move = _matrix(self.rotation), self.by_move(dynamics)
        if system.of_body.linear == 2:
            return by_move, by_move @ by_move
        own, whole = self._own(dynamics), u.reshape(-1, 6)[:, 3:]
        accelerated = block_diagonal(
            system,
            [p for w, v in zip(own, whole, strict=True) for p in (turning @ turning, _matrix(w - v) @ _matrix(w))],
        )
        if not len(self.spinning):
            return by_move, accelerated
        spins = self._spins_by_move(dynamics, t, rates, by_move)
        count = len(self.spinning)
        into = matrix_of(system, np.ones(count), self.spinning, np.arange(count), (system.n_u, count))
        gyroscopic = block_diagonal(system, [part for w in own for part in (np.zeros((3, 3)), _matrix(w))])
        return by_move + into @ spins, accelerated + gyroscopic @ into @ spins

    def by_move(self, dynamics: Dynamics) -> Matrix:
        """Return W x for displacements in ground axes and rotations in body axes, shape (n_u, n_u).

        It is the derivative of velocities by displacements without those of spins, and of accelerations by velocities.
        """
        if not np.any(self.rotation):
            return zeros(dynamics.system, dynamics.system.n_u, dynamics.system.n_u)
        turning, own = _matrix(self.rotation), self._own(dynamics)
        if dynamics.system.of_body.linear == 2:
            return block_diagonal(dynamics.system, [turning, np.zeros((1, 1))] * len(own))
        return block_diagonal(dynamics.system, [part for w in own for part in (turning, _matrix(w))])

    def _spins_by_move(self, dynamics: Dynamics, t: float, rates: Matrix, by_move: Matrix) -> Matrix:
        """Return derivatives of the spins that rolling determines by displacements."""
        state = dynamics.state
        state.evaluate("tangent", t)
        rows, across = self._rolling(dynamics, "tangent")
        if not len(rows):
            return zeros(dynamics.system, len(self.spinning), dynamics.system.n_u)
        missing = state.matrix("tangent", "V_q")[~dynamics.system.holonomic] @ dense(rates) + rows @ dense(by_move)
        spins = -np.linalg.lstsq(across, missing, rcond=EQUILIBRIA.no_effect)[0]
        row, column = np.indices(spins.shape).reshape(2, -1)
        return matrix_of(dynamics.system, spins.ravel(), row, column, spins.shape)

    def _rolling(self, dynamics: Dynamics, term_set: str = "motion") -> tuple[np.ndarray, np.ndarray]:
        """Return the rows of the nonholonomic constraints in J, and their columns of the spins."""
        rows = dynamics.state.matrix(term_set, "J")[~dynamics.system.holonomic]
        return rows, rows[:, self.spinning]

    def _places(self, dynamics: Dynamics) -> np.ndarray:
        of_body, count = dynamics.system.of_body, len(dynamics.system.bodies)
        return dynamics.state.q[: of_body.n_q * count].reshape(count, -1)[:, : of_body.linear]

    def _own(self, dynamics: Dynamics) -> np.ndarray:
        of_body, count = dynamics.system.of_body, len(dynamics.system.bodies)
        if of_body.linear == 2:
            return np.full((count, 1), self.rotation[0])
        if not np.any(self.rotation):
            return np.zeros((count, 3))
        turned = dynamics.state.q[: of_body.n_q * count].reshape(count, -1)[:, of_body.linear :]
        return rotated(CONJUGATE * turned, np.broadcast_to(self.rotation, (count, 3)))


def at_rest(dimensions: int) -> SteadyMotion:
    """Return the state of rest as a steady motion."""
    nothing = np.zeros(dimensions)
    return SteadyMotion(nothing, np.zeros(1 if dimensions == 2 else 3), nothing)


def _matrix(rotation: np.ndarray) -> np.ndarray:
    if len(rotation) == 1:
        return np.array([[0.0, -rotation[0]], [rotation[0], 0.0]])
    x, y, z = rotation
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _cross(rotation: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    return np.asarray(vectors @ _matrix(rotation).T)

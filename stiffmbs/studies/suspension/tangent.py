"""Motions of an axle near an equilibrium: derivatives of its pose and of the pads' forces by inputs and forces.

At rest K x + B dlam = f and J x = c hold for small changes of the pose x, of the multipliers dlam, of the forces f and
of the prescribed displacements c. With J N = 0 and L^T B = 0 the free motions follow from L^T K (x_c + N z) = L^T f, where
J x_c = c. Ideal joints leave z to idle freedoms such as the spin of a wheel; bushings determine it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...compile.quaternions import rotated
from ...dynamics.dynamics import Dynamics
from ...elements.forces.springs import AngleSpring, LineSpring, Spring
from ...equilibria.force_balance import balance_at
from ...equilibria.matrices import dense
from ...equilibria.steady_motion import at_rest
from ...errors import SolverError
from ...linear_analysis.state_space import Constraints
from ...model.model_data import ModelData
from ...reading.marker import GROUND, MarkerReference
from .rig import STEER

IDLE = 1e-12
"""Stiffness of a free motion, relative to the largest, below which forces do not determine it."""
UNMET = 1e-7
"""Violation of prescribed displacements, relative to the largest, that counts as a contradiction."""


@dataclass(frozen=True)
class Twist:
    """Velocity of a point and angular velocity of its body, per unit of an input, ground axes."""

    v: np.ndarray
    omega: np.ndarray

    def __add__(self, other: Twist) -> Twist:
        return Twist(self.v + other.v, self.omega + other.omega)

    def __mul__(self, factor: float) -> Twist:
        return Twist(factor * self.v, factor * self.omega)

    def at(self, arm: np.ndarray) -> np.ndarray:
        """Return the velocity of a point of the body with an arm from the own point."""
        found: np.ndarray = self.v + np.cross(self.omega, arm)
        return found


class Tangent:
    """Linearised equilibrium at the current pose of a system. `dynamics`: at an equilibrium. `t`: s."""

    def __init__(self, model: ModelData, dynamics: Dynamics, t: float) -> None:
        known = balance_at(dynamics, t, at_rest(3))
        system = dynamics.system
        self._model, self._system, self._q = model, system, dynamics.state.q.copy()
        self._scale = np.append(system.per_velocity(system.size, 1.0), system.state_scales)
        self._stiffness = dense(known.stiffness)
        self._jacobian, self._reactions = dense(known.jacobian), dense(known.reactions)
        self._lam = known.lam[system.active]
        self._joints = [joint for (joint, _), active in zip(system.equations, system.active, strict=True) if active]

    @property
    def size(self) -> int:
        """Number of the coordinates of a change of the pose."""
        return len(self._scale)

    def row(self, joint: str) -> int:
        """Return the row of a joint with one equation."""
        return self._joints.index(joint)

    def load(self, pad: str) -> float:
        """Return the force of a pad, N."""
        return -float(self._lam[self.row(pad)])

    @cached_property
    def held(self) -> Changes:
        """Changes with the pads' heights prescribed."""
        return Changes(self, np.arange(len(self._joints)), np.zeros((0, self.size)))

    def released(self, pads: list[str], locked: np.ndarray | None = None) -> Changes:
        """Return the changes without the pads, and with the lengths of springs locked: rows of shape (n, size)."""
        rows = np.array([k for k, joint in enumerate(self._joints) if joint not in pads], dtype=int)
        return Changes(self, rows, np.zeros((0, self.size)) if locked is None else locked)

    def columns(self, marker: MarkerReference) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the point of a marker, and the matrices of its velocity and angular velocity, shape (3, size)."""
        body, placed = self._model.carried(marker)
        v, omega = np.zeros((3, self.size)), np.zeros((3, self.size))
        if body == GROUND:
            return np.array(placed.point), v, omega
        k, kind = self._system.bodies.index(body), self._system.of_body
        q, first = self._q[kind.n_q * k : kind.n_q * (k + 1)], kind.n_u * k
        orientation = q[3:] / np.linalg.norm(q[3:])
        arm = rotated(orientation, np.array(placed.point))
        axes = rotated(orientation, np.eye(3))
        v[:, first : first + 3] = np.eye(3)
        v[:, first + 3 : first + 6] = np.cross(axes, arm).T
        omega[:, first + 3 : first + 6] = axes.T
        return q[:3] + arm, v, omega

    def axis(self, marker: MarkerReference, k: int) -> np.ndarray:
        """Return the k-th axis of a marker in ground axes."""
        body, placed = self._model.carried(marker)
        axis = rotated(np.array(placed.orientation), np.eye(3)[k])
        if body == GROUND:
            return axis
        first = self._system.of_body.n_q * self._system.bodies.index(body) + 3
        orientation = self._q[first : first + 4]
        return rotated(orientation / np.linalg.norm(orientation), axis)

    def lengthening(self, spring: LineSpring | AngleSpring) -> np.ndarray:
        """Return the derivative of the length or angle of a spring by the pose, shape (size,)."""
        (i, v_i, omega_i), (j, v_j, omega_j) = self.columns(spring.i), self.columns(spring.j)
        if isinstance(spring, AngleSpring):
            return np.asarray(self.axis(spring.j, 2) @ (omega_i - omega_j))
        line = i - j
        length = np.linalg.norm(line)
        return np.asarray(line @ (v_i - v_j) / length) if length else np.zeros(self.size)

    def wrench(self, marker: MarkerReference, force: np.ndarray, torque: np.ndarray, arm: np.ndarray) -> np.ndarray:
        """Return the generalised force of a force with an arm from a marker, and a torque, on the marker's body."""
        _, v, omega = self.columns(marker)
        return np.asarray(v.T @ force + omega.T @ (torque + np.cross(arm, force)))


class Changes:
    """Solutions of the linearised equilibrium with some of the constraints.

    `rows`: constraints that hold. `locked` of shape (n, size): further rows, whose displacements are zero.
    """

    def __init__(self, tangent: Tangent, rows: np.ndarray, locked: np.ndarray) -> None:
        self._tangent, self._rows, self._locked = tangent, rows, locked
        scale = tangent._scale
        self._constraints = Constraints(np.vstack([tangent._jacobian[rows], locked]) * scale)
        self._free = self._constraints.null_space
        reactions = np.hstack([tangent._reactions[:, rows], locked.T]).T * scale
        same = np.array_equal(reactions, np.vstack([tangent._jacobian[rows], locked]) * scale)
        self._balances = self._constraints if same else Constraints(reactions)
        left = self._balances.null_space
        self._scaled = scale[:, None] * tangent._stiffness * scale
        self._left = left
        self._inverse = _inverse(left.T @ self._scaled @ self._free, IDLE * np.max(np.abs(self._scaled), initial=0.0))

    def moved(self, joint: str) -> np.ndarray:
        """Return the change of the pose per displacement that a joint prescribes.

        Raises SolverError if the other constraints prevent it.
        """
        right = np.zeros((len(self._rows) + len(self._locked), 1))
        right[np.flatnonzero(self._rows == self._tangent.row(joint))] = 1.0
        found = self._constraints.smallest(right)
        rows = np.vstack([self._tangent._jacobian[self._rows], self._locked]) * self._tangent._scale
        if np.max(np.abs(rows @ found - right)) > UNMET:
            raise SolverError(f"joint '{joint}' cannot move in this pose")
        return self._with_free(found[:, 0], np.zeros(self._tangent.size))

    def pushed(self, force: np.ndarray) -> np.ndarray:
        """Return the change of the pose under a generalised force."""
        return self._with_free(np.zeros(self._tangent.size), self._tangent._scale * force)

    def _with_free(self, prescribed: np.ndarray, force: np.ndarray) -> np.ndarray:
        left = self._left.T @ (force - self._scaled @ prescribed)
        return np.asarray(self._tangent._scale * (prescribed + self._free @ (self._inverse @ left)))

    def reaction(self, joint: str, x: np.ndarray) -> float:
        """Return the change of the multiplier of a joint for a change of the pose without other forces."""
        right = np.zeros((len(self._rows) + len(self._locked), 1))
        right[np.flatnonzero(self._rows == self._tangent.row(joint))] = 1.0
        only = self._balances.smallest(right)[:, 0]
        return float(-only @ (self._scaled @ (x / self._tangent._scale)))


def _inverse(stiffness: np.ndarray, idle: float) -> np.ndarray:
    """Return the inverse of the stiffness of the free motions; those softer than `idle` stay at rest."""
    if not stiffness.size:
        return np.zeros(stiffness.T.shape)
    u, s, v = np.linalg.svd(stiffness)
    kept = s > idle
    return np.asarray((v[kept].T / s[kept]) @ u[:, kept].T)


def steering_motion(tangent: Tangent, pads: list[str], springs: list[Spring]) -> np.ndarray | None:
    """Return the change of the pose by steering with the springs locked, or None if that is not possible.

    Blundell and Harty, The Multibody Systems Approach to Vehicle Dynamics (2004), chapter 4.
    """
    stiff = [each for each in springs if each.stiffness or each.spring_law is not None]  # type: ignore[attr-defined]
    if not stiff:
        return None
    locked = np.array([tangent.lengthening(each) for each in stiff])  # type: ignore[arg-type]
    try:
        return tangent.released(pads, locked).moved(STEER)
    except SolverError:
        return None


STILL = 1e-9
"""Angular velocity per unit of steering below which a wheel does not steer, rad/m or rad/rad."""
LEVEL = 1e-6
"""Smallest upward component of a direction that intersects the road."""


@dataclass(frozen=True)
class SteeringAxis:
    """Axis of a motion.

    `direction` of shape (3,): unit vector, upwards. `arm` of shape (3,): vector from the centre of the wheel to the
    nearest point of the axis, m.
    """

    direction: np.ndarray
    arm: np.ndarray


def steering_axis(locked: Twist | None, held: Twist, bump: Twist) -> SteeringAxis | None:
    """Return the steering axis of a wheel, or None if it does not steer about an axis.

    `locked`: motion of the carrier, at the centre of the wheel, by steering with the springs locked. Without it the
    axis is that of the pure rotation nearest to `held` among the sums of `held` and a multiple of `bump`. `held`:
    motion by steering with the heights of the contacts held. `bump`: motion by lifting.
    """
    twist = locked or _rotation(held, bump)
    square = float(twist.omega @ twist.omega)
    if np.sqrt(square) < STILL:
        return None
    direction = twist.omega / np.sqrt(square)
    if abs(direction[2]) < LEVEL:
        return None
    return SteeringAxis(direction * np.sign(direction[2]), np.cross(twist.omega, twist.v) / square)


def _rotation(held: Twist, bump: Twist) -> Twist:
    """Return the sum of steering and a multiple of lifting whose screw has the smallest pitch."""
    a, c = float(bump.omega @ bump.v), float(held.omega @ held.v)
    b = float(bump.omega @ held.v + held.omega @ bump.v)
    roots = np.roots([a, b, c]) if abs(a) * 1e12 > abs(b) else np.array([-c / b if b else 0.0])
    real = roots[np.abs(roots.imag) <= 1e-9 * (1 + np.abs(roots.real))].real
    multiple = min(real, key=abs) if len(real) else -b / (2 * a)
    return held + bump * float(multiple)

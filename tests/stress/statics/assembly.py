"""Static equilibrium of elastic assemblies in space: an independent check of `kc`, `loads` and equilibria.

It shares no code with the solver: orientations are rotation vectors, derivatives are finite differences.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from scipy.spatial.transform import Rotation

GROUND = "ground"
BALANCED = 1e-9
"""Residual of forces and moments in units of `FORCE`, and of constraints, m, that counts as a solution."""


@dataclass(frozen=True)
class Pose:
    """Position, m, and rotation matrix of a body."""

    position: np.ndarray
    rotation: np.ndarray

    def at(self, point: np.ndarray) -> np.ndarray:
        """Return a point of the body in ground axes, m."""
        return np.asarray(self.position + self.rotation @ point)


class Wrenches:
    """Forces, N, and moments about the bodies' origins, N m, summed for each body."""

    def __init__(self, poses: dict[str, Pose]) -> None:
        self.poses = poses
        self.sums = {name: np.zeros(6) for name in poses}

    def add(self, body: str, place: np.ndarray, force: np.ndarray, torque: np.ndarray | float = 0.0) -> None:
        """Add a force at a place in ground axes, and a torque."""
        arm = place - self.poses[body].position
        self.sums[body] += np.concatenate([force, np.cross(arm, force) + torque])


class Part(Protocol):
    """Element that adds its wrenches and returns its constraint violations, one for each of its multipliers."""

    @property
    def unknowns(self) -> int:
        """Number of multipliers."""
        ...

    def act(self, wrenches: Wrenches, multipliers: np.ndarray, load: float) -> np.ndarray:
        """Add the wrenches for multipliers, N, and a load factor from 0 to 1."""
        ...


@dataclass(frozen=True)
class End:
    """Point of a body with axes: the columns of a rotation matrix in body axes."""

    body: str
    point: np.ndarray
    axes: np.ndarray = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True)
class ElasticBushing:
    """Bushing with six uncoupled stiffnesses, N/m and N m/rad, along the axes of j; rotations are a rotation vector."""

    i: End
    j: End
    stiffness: np.ndarray
    unknowns: int = 0

    def load(self, poses: dict[str, Pose]) -> np.ndarray:
        """Return force and torque on i along the axes of j, N and N m."""
        of_i, of_j = poses[self.i.body], poses[self.j.body]
        axes = of_j.rotation @ self.j.axes
        way = axes.T @ (of_i.at(self.i.point) - of_j.at(self.j.point))
        turn = Rotation.from_matrix(axes.T @ of_i.rotation @ self.i.axes).as_rotvec()
        return np.concatenate([-self.stiffness[:3] * way, _torque_of_rotation_vector(turn, -self.stiffness[3:] * turn)])

    def act(self, wrenches: Wrenches, multipliers: np.ndarray, load: float) -> np.ndarray:
        """Add the elastic wrench on i, and its opposite on j at the same point."""
        axes = wrenches.poses[self.j.body].rotation @ self.j.axes
        along = self.load(wrenches.poses)
        force, torque = axes @ along[:3], axes @ along[3:]
        place = wrenches.poses[self.i.body].at(self.i.point)
        wrenches.add(self.i.body, place, force, torque)
        wrenches.add(self.j.body, place, -force, -torque)
        return multipliers


@dataclass(frozen=True)
class Line:
    """Linear spring between two points or, without a stiffness, a rod of fixed length."""

    i: End
    j: End
    length: float
    stiffness: float | None
    unknowns: int = 0

    def act(self, wrenches: Wrenches, multipliers: np.ndarray, load: float) -> np.ndarray:
        """Add the forces along the line; the multiplier of a rod is its compressive force."""
        one, other = (wrenches.poses[end.body].at(end.point) for end in (self.i, self.j))
        way = one - other
        distance = np.linalg.norm(way)
        pressure = multipliers[0] if self.stiffness is None else self.stiffness * (self.length - distance)
        wrenches.add(self.i.body, one, pressure * way / distance)
        wrenches.add(self.j.body, other, -pressure * way / distance)
        return np.array([distance - self.length][: self.unknowns])


@dataclass(frozen=True)
class Ball:
    """Spherical joint: two points coincide."""

    i: End
    j: End
    unknowns: int = 3

    def act(self, wrenches: Wrenches, multipliers: np.ndarray, load: float) -> np.ndarray:
        """Add the reaction on i and its opposite on j."""
        one, other = (wrenches.poses[end.body].at(end.point) for end in (self.i, self.j))
        wrenches.add(self.i.body, one, multipliers)
        wrenches.add(self.j.body, other, -multipliers)
        return np.asarray(one - other)


@dataclass(frozen=True)
class Pad:
    """Vertical force that holds a wheel's lowest point at a height, m, between those at zero and full load.

    The wheel, with its axis along y of the end's body and its centre at the end, rolls.
    """

    at: End
    radius: float
    rest: float
    lifted: float
    unknowns: int = 1

    def contact(self, pose: Pose) -> np.ndarray:
        """Return the lowest point of the wheel, m."""
        axis = pose.rotation[:, 1]
        up = np.array([0.0, 0.0, 1.0]) - axis[2] * axis
        return np.asarray(pose.at(self.at.point) - self.radius * up / np.linalg.norm(up))

    def act(self, wrenches: Wrenches, multipliers: np.ndarray, load: float) -> np.ndarray:
        """Add the vertical force."""
        place = self.contact(wrenches.poses[self.at.body])
        wrenches.add(self.at.body, place, np.array([0.0, 0.0, multipliers[0]]))
        return np.array([place[2] - self.rest - load * self.lifted])


@dataclass(frozen=True)
class Push:
    """Constant force, N, and torque, N m, in ground axes at a point, times the load factor; weights act fully from the start."""

    at: End
    force: np.ndarray
    torque: np.ndarray = field(default_factory=lambda: np.zeros(3))
    constant: bool = False
    unknowns: int = 0

    def act(self, wrenches: Wrenches, multipliers: np.ndarray, load: float) -> np.ndarray:
        """Add force and torque."""
        part = 1.0 if self.constant else load
        wrenches.add(
            self.at.body, wrenches.poses[self.at.body].at(self.at.point), part * self.force, part * self.torque
        )
        return multipliers


def equilibria(
    places: dict[str, np.ndarray], parts: list[Part], loads: np.ndarray
) -> list[tuple[dict[str, Pose], np.ndarray]] | None:
    """Return poses and multipliers at increasing load factors, or None if the iteration does not converge.

    Parameters
    ----------
    places : dict of str to ndarray
        Origins of the bodies as described, m, with axes parallel to those of the ground.
    parts : list of Part
    loads : ndarray
        Load factors, from 0.
    """
    names = list(places)
    count = sum(part.unknowns for part in parts)
    ground = Pose(np.zeros(3), np.eye(3))

    def poses(x: np.ndarray) -> dict[str, Pose]:
        """Return the poses of all bodies for the unknowns."""
        found = {GROUND: ground}
        for k, name in enumerate(names):
            moved = x[6 * k : 6 * k + 6]
            found[name] = Pose(places[name] + moved[:3], Rotation.from_rotvec(moved[3:]).as_matrix())
        return found

    def residual(load: float) -> Callable[[np.ndarray], np.ndarray]:
        """Return the residual for a load factor."""

        def of(x: np.ndarray) -> np.ndarray:
            """Return sums of forces and moments, and violations of the constraints."""
            wrenches, violations = Wrenches(poses(x)), []
            at = 6 * len(names)
            for part in parts:
                violations.append(part.act(wrenches, FORCE * x[at : at + part.unknowns], load)[: part.unknowns])
                at += part.unknowns
            balance = np.concatenate([wrenches.sums[name] for name in names])
            return np.concatenate([balance / FORCE, *violations])

        return of

    x = np.zeros(6 * len(names) + count)
    found = []
    for load in loads:
        solved = _newton(residual(load), x)
        if solved is None:
            return None
        x = solved
        found.append((poses(x), FORCE * x[6 * len(names) :]))
    return found


def _newton(residual: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray | None:
    """Return a zero by Newton's iteration with forward differences, or None if it does not converge."""
    for _ in range(MOST_ITERATIONS):
        value = residual(x)
        if not np.all(np.isfinite(value)):
            return None
        if np.max(np.abs(value)) < BALANCED:
            return x
        jacobian = np.stack([(residual(x + step) - value) / STEP for step in STEP * np.eye(len(x))], axis=1)
        move = np.linalg.lstsq(jacobian, -value, rcond=None)[0]
        x = x + move * min(1.0, LONGEST / max(float(np.max(np.abs(move))), LONGEST))
    return None


MOST_ITERATIONS = 30
STEP = 1e-7
"""Step of forward differences, m, rad or `FORCE`."""
LONGEST = 0.1
"""Largest step of an iteration, in the same units."""
FORCE = 1e4
"""Unit of forces, N, so that they have the size of displacements."""


def _torque_of_rotation_vector(turn: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Return the torque whose power is that of a moment on the rates of a rotation vector: J_l^-T m."""
    angle = float(np.linalg.norm(turn))
    x, y, z = turn
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    if angle < 1e-4:
        factor = 1 / 12 + angle**2 / 720
    else:
        factor = 1 / angle**2 - (1 + np.cos(angle)) / (2 * angle * np.sin(angle))
    inverse = np.eye(3) - cross / 2 + factor * cross @ cross
    return np.asarray(inverse.T @ moment)

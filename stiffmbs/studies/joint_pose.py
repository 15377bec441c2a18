"""Pose and velocities of a mechanism with given coordinates and rates of joints."""

from __future__ import annotations

import math
import numbers
from collections.abc import Collection, Mapping
from typing import Final

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.native.parameters import CONSISTENCY, ELIMINATION
from ..elements.turns import TURN
from ..errors import InputError
from ..reading.did_you_mean import instead_of
from ..results.joint_coordinates import JointCoordinates

PART: Final = 0.5
"""Largest change of a joint coordinate between two poses that Newton's iteration follows, rad, or sizes of the mechanism."""
MOST_PARTS: Final = 400
"""Largest number of such poses: 200 rad, or sizes of the mechanism."""
KEPT: Final = 1e-3
"""Weight of coordinates that are not given, which stay where they are if no loop moves them."""


def named_coordinates(joints: JointCoordinates, given: Mapping[str, float], what: str) -> dict[int, float]:
    """Return the given values by the number of their coordinate; ``hinge`` stands for its only coordinate.

    Raises InputError if there is no such coordinate, or a value is not finite.
    """
    alone: dict[str, list[int]] = {}
    for k, name in enumerate(joints.names):
        alone.setdefault(name.rpartition(".")[0], []).append(k)
    places = {name: found[0] for name, found in alone.items() if len(found) == 1}
    places |= {name: k for k, name in enumerate(joints.names)}
    for name, value in given.items():
        if name not in places:
            raise InputError(f"{what} '{name}': found no such joint coordinate{instead_of(name, joints.names)}")
        if not isinstance(value, numbers.Real) or not math.isfinite(value):
            raise InputError(f"{what} '{name}': found {value!r}, expected a finite number")
    return {places[name]: float(value) for name, value in given.items()}


def weights(count: int, given: Collection[int]) -> np.ndarray:
    """Return the weights of joint coordinates in least squares: 1 for those that are given."""
    found = np.full(count, KEPT)
    found[list(given)] = 1.0
    return found


def parts_of(change: float, what: str = "reset") -> int:
    """Return the number of poses to which Newton's iteration follows a change of a coordinate, rad or sizes.

    Raises InputError if they are too many.
    """
    parts = max(1, math.ceil(change / PART))
    if parts > MOST_PARTS:
        raise InputError(
            f"{what}: found a joint coordinate {change:.3g} rad (or sizes of the mechanism) from its start, expected at most {MOST_PARTS * PART:g}"
        )
    return parts


class JointPose:
    """Poses near a given one, and the linear equations of their small changes.

    `dynamics`: its state is changed. `t`: time, s. `q`: pose to begin with.
    """

    def __init__(self, dynamics: Dynamics, joints: JointCoordinates, t: float, q: np.ndarray) -> None:
        self._dynamics, self._joints, self._t, self.q = dynamics, joints, t, q.copy()
        self._u, self._active = np.zeros(dynamics.system.n_u), dynamics.system.active
        self._turning = np.array([name in joints.angles for name in joints.names], dtype=bool)
        self._unit = dynamics.system.per_velocity(dynamics.system.size or 1.0, 1.0)
        joints.watch(self.q, self._u)

    def move_to(self, given: Mapping[int, float]) -> None:
        """Change coordinates of joints; others keep their values if no loop moves them.

        Raises InputError if the joints cannot have these coordinates.
        """
        first, weight = self._coordinates(), weights(len(self._joints.names), given)
        goal = first.copy()
        goal[list(given)] = [*given.values()]
        of_angles = [name.rpartition(".")[2].startswith("angle") for name in self._joints.names]
        unit = np.where(of_angles, 1.0, self._dynamics.system.size or 1.0)
        parts = parts_of(np.abs((goal - first) / unit).max(initial=0.0))
        for part in range(1, parts + 1):
            self._solve(first + (goal - first) * part / parts, weight)
        weight[weight < 1.0] = 0.0
        if not self._solve(goal, weight) <= CONSISTENCY.position_tolerance:
            raise self._refused("pose", "coordinates", given)

    def velocities(self, u: np.ndarray, given: Mapping[int, float]) -> np.ndarray:
        """Return velocities on the constraints, near given ones, with rates of joints, 0 where none is given if no loop moves them.

        Raises InputError if the joints cannot have the given rates.
        """
        goal, weight = np.zeros(len(self._joints.names)), weights(len(self._joints.names), given)
        goal[list(given)] = [*given.values()]
        matrix, rates, found = self._matrix(), self.rate_matrix(), u.copy()
        for factor in (weight, np.where(weight < 1.0, 0.0, 1.0)):
            left = np.concatenate([self._rate_violation(found), factor * (rates @ found - goal)])
            found -= _least_squares(np.vstack([matrix, factor[:, None] * rates]), left)
        left = np.concatenate([self._rate_violation(found), factor * (rates @ found - goal)])
        if not np.abs(left).max(initial=0.0) <= ELIMINATION.least_residual * max(1.0, np.abs(found).max(initial=0.0)):
            raise self._refused("motion", "rates", given)
        return found

    def _refused(self, what: str, values: str, given: Mapping[int, float]) -> InputError:
        named = ", ".join(f"{self._joints.names[k]} = {value:g}" for k, value in given.items())
        return InputError(
            f"reset: no {what} of the mechanism has the joint {values} {named}; expected {values} that its joints allow together"
        )

    def _solve(self, goal: np.ndarray, weight: np.ndarray) -> float:
        """Move to coordinates by Newton's iteration; return the largest equation that is left."""
        left = np.inf
        for _ in range(CONSISTENCY.most_assembly_moves):
            away = self._coordinates() - goal
            away[self._turning] -= TURN * np.round(away[self._turning] / TURN)
            violations = np.concatenate([self._violation(), weight * away])
            left = float(np.abs(violations).max(initial=0.0))
            if left <= CONSISTENCY.position_tolerance:
                break
            matrix = np.vstack([self._matrix(), weight[:, None] * self.rate_matrix()])
            move = -_least_squares(matrix, violations)
            longest = np.abs(move / self._unit).max(initial=0.0) / PART  # a longer move leaves the linear range
            self.q[:] = self._dynamics.system.of_body.moved(self.q, move / max(1.0, longest))
        return left

    def _coordinates(self) -> np.ndarray:
        state = self._dynamics.state
        state.q[:] = self.q
        state.restart_counters(self._t)  # to the turns nearest to those before the move
        self.q[:] = state.q
        self._joints.follow(self._t)
        return self._joints.coordinates.copy()

    def rate_matrix(self) -> np.ndarray:
        """Return the rates of joint coordinates by velocities, shape (coordinates, n_u)."""
        columns = []
        for k in range(len(self._u)):
            self._u[k] = 1.0
            self._joints.follow(self._t)
            columns.append(self._joints.rates.copy())
            self._u[k] = 0.0
        return np.transpose(columns) if columns else np.zeros((len(self._joints.names), 0))

    def _evaluate(self, u: np.ndarray) -> np.ndarray:
        state, n_c = self._dynamics.state, self._dynamics.system.n_c
        state.q[:], state.u[:] = self.q, u
        state.evaluate("motion", self._t)
        found: np.ndarray = state.values["motion"][: 2 * n_c].reshape(2, n_c)[:, self._active].copy()
        return found

    def _violation(self) -> np.ndarray:
        return self._evaluate(self._u)[0]

    def _rate_violation(self, u: np.ndarray) -> np.ndarray:
        return self._evaluate(u)[1]

    def _matrix(self) -> np.ndarray:
        self._evaluate(self._u)
        return self._dynamics.state.matrix("motion", "J")[self._active]


def _least_squares(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the smallest solution of a linear system, also if some equations depend on others."""
    found: np.ndarray = np.linalg.lstsq(matrix, right, rcond=None)[0]
    return found

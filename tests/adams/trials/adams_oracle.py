"""Motion and reactions of parts with markers, a second way: accelerations and multipliers from one linear system.

Nothing here is shared with the package: numpy and scipy alone, ground axes throughout, rotation matrices from one
quaternion a part. A constraint is written as vectors that know their first two time derivatives (`Jet`), and its
Jacobian is read off the second derivative, which is linear in the accelerations. DOP853 at 1e-12 keeps the
constraints to some 1e-11 over the seconds that are needed, so nothing is projected.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

from ...minimal_coordinates import turned


def euler(*degrees) -> np.ndarray:
    """Rotation matrix of Adams' 3-1-3 angles REULER (degrees)."""
    a, b, c = np.radians(degrees)
    return turned((0, 0, 1), a) @ turned((1, 0, 0), b) @ turned((0, 0, 1), c)


def tensor(xx, yy, zz, xy=0.0, xz=0.0, yz=0.0) -> np.ndarray:
    """Inertia tensor (3, 3) of Adams' IP: products are positive integrals, so they enter with the other sign."""
    return np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])


@dataclass(frozen=True)
class Jet:
    """A scalar or vector: value (..), rate (..), and second derivative (b, ..) for b sets of accelerations."""

    value: np.ndarray
    rate: np.ndarray
    second: np.ndarray

    def __add__(self, other):
        return Jet(self.value + other.value, self.rate + other.rate, self.second + other.second)

    def __sub__(self, other):
        return self + other * -1.0

    def __mul__(self, factor):
        return Jet(self.value * factor, self.rate * factor, self.second * factor)

    def __matmul__(self, other):
        """Scalar product of two vectors."""
        return Jet(
            self.value @ other.value,
            self.rate @ other.value + self.value @ other.rate,
            self.second @ other.value + 2 * self.rate @ other.rate + other.second @ self.value,
        )

    def length(self):
        square = self @ self
        value = np.sqrt(square.value)
        rate = square.rate / (2 * value)
        return Jet(value, rate, (square.second / 2 - rate**2) / value)


@dataclass(frozen=True)
class Part:
    """A body: mass (kg), inertia (3, 3) about its centre in its own axes, and its start in ground axes."""

    mass: float
    inertia: np.ndarray
    center: tuple
    turn: np.ndarray = field(default_factory=lambda: np.eye(3))
    velocity: tuple = (0, 0, 0)
    spin: tuple = (0, 0, 0)


@dataclass(frozen=True)
class Marker:
    """A point and axes on a part (index, -1 the ground), where they are at the start, in ground axes."""

    part: int
    place: tuple = (0, 0, 0)
    turn: np.ndarray = field(default_factory=lambda: np.eye(3))


class View:
    """All that constraints and forces may ask of one instant."""

    def __init__(self, parts, t, y):
        self.parts, self.t = parts, t
        n = len(parts)
        self.r, p, self.v, self.w = (np.split(y, [3 * n, 7 * n, 10 * n])[k].reshape(n, -1) for k in range(4))
        self.turns = [rotation(q) for q in p]
        self.tries = np.vstack([np.zeros(6 * n), np.eye(6 * n)]).reshape(-1, 2, n, 3)  # (1 + 6 n, linear/angular, n, 3)
        self.load = np.zeros((2, n, 3))

    def _arm(self, k, start):
        """A vector fixed in part k, given as it was at the start."""
        return self.turns[k] @ self.parts[k].turn.T @ np.asarray(start, float)

    def fixed(self, k, start) -> Jet:
        """Jet of a vector fixed in part k."""
        if k < 0:
            return Jet(np.asarray(start, float), np.zeros(3), np.zeros((len(self.tries), 3)))
        a, w = self._arm(k, start), tilde(self.w[k])
        return Jet(a, w @ a, self.tries[:, 1, k] @ tilde(a) + w @ w @ a)

    def point(self, m: Marker) -> Jet:
        if m.part < 0:
            return self.fixed(-1, m.place)
        k = m.part
        return Jet(self.r[k], self.v[k], self.tries[:, 0, k]) + self.fixed(
            k, np.subtract(m.place, self.parts[k].center)
        )

    def axis(self, m: Marker, name: str) -> Jet:
        return self.fixed(m.part, m.turn[:, "xyz".index(name)])

    def axes(self, m: Marker) -> np.ndarray:
        """Axes of a marker as columns."""
        return np.column_stack([self.axis(m, name).value for name in "xyz"])

    def spin(self, m: Marker) -> Jet:
        """Angular velocity as the *rate* of a jet, angular acceleration as its second derivative."""
        k = m.part
        zero = np.zeros(3)
        return Jet(zero, self.w[k], self.tries[:, 1, k]) if k >= 0 else self.fixed(-1, zero)

    def push(self, m: Marker, at, force, torque=(0, 0, 0)):
        """Force at a point and torque, in ground axes, on the part of a marker."""
        if m.part >= 0:
            self.load[0, m.part] += force
            self.load[1, m.part] += torque + np.cross(at - self.r[m.part], force)


def tilde(a) -> np.ndarray:
    """Matrix of a x b as a function of b; some times faster than `np.cross`."""
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def rotation(q) -> np.ndarray:
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(turn) -> np.ndarray:
    """Unit quaternion of a rotation matrix, by the eigenvector of Bar-Itzhack's matrix."""
    m = np.zeros((4, 4))
    m[0, 0] = np.trace(turn)
    m[1:, 1:] = turn + turn.T - np.trace(turn) * np.eye(3)
    m[0, 1:] = m[1:, 0] = [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
    return np.linalg.eigh(m)[1][:, -1]


@dataclass(frozen=True)
class Mechanism:
    """Parts, joints (name -> function of a `View`, giving second derivatives (rows, b)) and forces (functions of it)."""

    parts: list
    joints: dict[str, Callable] = field(default_factory=dict)
    forces: list[Callable] = field(default_factory=list)
    gravity: tuple = (0, 0, -9.80665)

    def _start(self):
        p = self.parts
        rows = [[b.center for b in p], [quaternion(b.turn) for b in p], [b.velocity for b in p], [b.spin for b in p]]
        return np.concatenate([np.ravel(row).astype(float) for row in rows])

    def solve(self, t, y):
        """View at a state, accelerations (2, n, 3), and what each joint does to each part: name -> (2, n, 3)."""
        view, n = View(self.parts, t, y), len(self.parts)
        mass, load = np.zeros((6 * n, 6 * n)), np.zeros((2, n, 3))
        for force in self.forces:
            force(view)
        for k, part in enumerate(self.parts):
            inertia = view.turns[k] @ part.inertia @ view.turns[k].T
            mass[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = part.mass * np.eye(3)
            mass[3 * (n + k) : 3 * (n + k) + 3, 3 * (n + k) : 3 * (n + k) + 3] = inertia
            load[0, k] = view.load[0, k] + part.mass * np.array(self.gravity)
            load[1, k] = view.load[1, k] - tilde(view.w[k]) @ inertia @ view.w[k]
        rows = {name: np.atleast_2d(joint(view)) for name, joint in self.joints.items()}
        every = np.vstack([*rows.values(), np.zeros((0, 6 * n + 1))])
        jacobian, bias = every[:, 1:] - every[:, :1], every[:, 0]
        whole = np.block([[mass, jacobian.T], [jacobian, np.zeros((len(every),) * 2)]])
        found = np.linalg.solve(whole, np.concatenate([load.ravel(), -bias]))
        pulls, at = {}, 0
        for name, own in rows.items():
            part = slice(at, at := at + len(own))
            pulls[name] = -(jacobian[part].T @ found[6 * n :][part]).reshape(2, n, 3)
        return view, found[: 6 * n].reshape(2, n, 3), pulls

    def _rates(self, t, y):
        view, accelerations, _ = self.solve(t, y)
        n = len(self.parts)
        p = y[3 * n : 7 * n].reshape(n, 4)
        w = view.w
        turn = 0.5 * np.column_stack([-np.sum(p[:, 1:] * w, 1), p[:, :1] * w + np.cross(w, p[:, 1:])])
        return np.concatenate([view.v.ravel(), turn.ravel(), accelerations.ravel()])

    def run(self, t, rtol=1e-12, max_step=np.inf) -> History:
        """Solve from the start to t[-1]; steps without a bound pass over what forces do for a moment."""
        found = solve_ivp(
            self._rates, (0, t[-1]), self._start(), "DOP853", t_eval=t, rtol=rtol, atol=rtol, max_step=max_step
        )
        return History(self, [self.solve(time, y) for time, y in zip(found.t, found.y.T, strict=True)])


@dataclass(frozen=True)
class History:
    """The instants of a run."""

    mechanism: Mechanism
    instants: list

    def ask(self, question) -> np.ndarray:
        """Any function of the view at each instant, over time."""
        return np.array([question(view) for view, _, _ in self.instants])

    def part(self, k) -> dict[str, np.ndarray]:
        """Channels of a part as the package names them: its axes are those of its inertia, spins are along them."""
        turns = np.array([view.turns[k] for view, _, _ in self.instants])
        spins, gains = (
            np.array(rows)
            for rows in zip(
                *[(view.w[k], accelerations[1, k]) for view, accelerations, _ in self.instants], strict=True
            )
        )
        tables = {
            ("x", "y", "z"): self.ask(lambda view: view.r[k]),
            ("vx", "vy", "vz"): self.ask(lambda view: view.v[k]),
            ("ax", "ay", "az"): np.array([a[0, k] for _, a, _ in self.instants]),
            ("wx", "wy", "wz"): np.einsum("tij,ti->tj", turns, spins),
            ("wdx", "wdy", "wdz"): np.einsum("tij,ti->tj", turns, gains),
        }
        return {name: table[:, i] for names, table in tables.items() for i, name in enumerate(names)} | {"turn": turns}

    def reaction(self, joint, marker: Marker) -> np.ndarray:
        """What a joint does to the part of a marker (t, 6): force, and torque about the marker, in ground axes."""
        rows = []
        for view, _, pulls in self.instants:
            at, sign, k = view.point(marker).value, 1.0, marker.part
            if k < 0:  # what the ground feels is what all parts feel, with the other sign
                (force, torque), sign = pulls[joint], -1.0
                total = force.sum(0), (torque + np.cross(view.r - at, force)).sum(0)
            else:
                force, torque = pulls[joint][:, k]
                total = force, torque + np.cross(view.r[k] - at, force)
            rows.append(sign * np.concatenate(total))
        return np.array(rows)

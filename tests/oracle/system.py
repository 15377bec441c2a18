"""Independent equations of motion of a scene: rigid bodies, joints, drives, couplers, forces by formula, springs, bushings, states.

Everything is in ground axes: r and A of all bodies, their velocities u = (r', w), and the states.  Nothing is shared with the
package.  Jacobians of constraints are complex steps (Squire and Trapp, SIAM Review 40, 1998); their second derivatives by
time, and all linearisations, are central differences of sixth order.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from . import forces
from .elements import Elements, State, Unknown
from .formulas import FUNCTIONS, Values, value
from .geometry import Poses, about_z, arctan2, cross, of_quaternion

TINY = 1e-30
SIXTH = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
"""Central differences of sixth order."""
TIME_STEP = 5e-4
"""Step of the second derivatives of constraints by time, s."""


@dataclass(frozen=True)
class Motion:
    """Accelerations of shape (bodies, 6), multipliers, rates of the states, and the values of formulas."""

    a: np.ndarray
    lam: np.ndarray
    rates: np.ndarray
    values: Values


def difference(function, step):
    """Return the derivative of a function of one number at zero, by sixth order."""
    return sum(w * (function(k * step) - function(-k * step)) for k, w in SIXTH) / step


class System(Elements):
    """Equations of a scene's content.  Raises `Unknown` if it has other elements."""

    def _values(self, poses, u, s, t):
        known = {**FUNCTIONS, **self.parameters, **self.inputs, "t": t}
        known["channel"] = lambda body, label: self._channel(poses, u, body, label)
        known["measure"] = lambda sort, *names: self._measure(poses, u, sort, names)
        states = {
            each.name: (lambda values, each=each, a=a, b=b: each.output(s[a:b], values))
            for each, a, b in zip(self.linear, self.places[:-1], self.places[1:], strict=True)
        }
        if not self.algebraic:
            return Values(known, states)
        z = np.zeros(len(self.algebraic))

        def residual(z):
            values = Values({**known, **dict(zip(self.algebraic, z, strict=True))}, states)
            return np.array([value(law, values) for law in self.algebraic.values()])

        for _ in range(40):
            jacobian = np.array([difference(lambda h, e=e, z=z: residual(z + h * e), 1e-3) for e in np.eye(len(z))]).T
            move = np.linalg.solve(jacobian, residual(z))
            z = z - move
            if np.max(np.abs(move)) < 1e-14:
                break
        return Values({**known, **dict(zip(self.algebraic, z, strict=True))}, states)

    def _channel(self, poses, u, body, label):
        k = self.index[body]
        if label in "xyz":
            return poses.r[k, "xyz".index(label)]
        if label in ("vx", "vy", "vz"):
            return u[k, "xyz".index(label[1])]
        if label == "omega":
            return u[k, 5]
        if label == "angle":
            turned = about_z(self.angles[k]).T @ poses.A[k]
            return self.angles[k] + arctan2(turned[1, 0], turned[0, 0])
        raise Unknown(label)

    def _measure(self, poses, u, sort, names):
        origins = [self.marker(name) for name in names]
        a, b = origins[0], origins[1] if len(origins) > 1 else self.marker("ground")
        d = a.at(poses) - b.at(poses)
        v = a.velocity(poses, u) - b.velocity(poses, u)
        if sort == "dm":
            return np.sqrt(d @ d)
        if sort == "vr":
            return d @ v / np.sqrt(d @ d)
        axes = origins[2].turned(poses) if len(origins) > 2 else np.eye(3)
        return axes[:, "xyz".index(sort[1])] @ (d if sort[0] == "d" else v)

    def residual(self, poses, t):
        """Return C, with the driven coordinates of velocities."""
        return np.array([part for row in self.rows for part in row(poses, t)])

    @property
    def row_places(self):
        """First residual of each function of residuals, and the number of residuals."""
        counts = [len(row(self.start.poses, 0.0)) for row in self.rows]
        return np.cumsum([0, *counts])

    def jacobian(self, poses, t):
        """Return J of all bodies and the ground, shape (equations, 6 bodies)."""
        unit = np.eye(6 * (self.n + 1))
        return np.array([
            np.imag(self.residual(poses.moved(way.reshape(-1, 6), 1j * TINY), t)) / TINY for way in unit
        ]).T.reshape(-1, 6 * (self.n + 1))  # fmt: skip

    def rate(self, poses, u, t):
        """Return the velocity residuals C' - v(t)."""
        moving = np.imag(self.residual(poses.moved(u, 1j * TINY), t)) / TINY
        of_time = difference(lambda h: self.residual(poses, t + h), TIME_STEP)
        return moving + of_time - self._prescribed(t)

    def _prescribed(self, t):
        found = np.zeros(int(self.row_places[-1]))
        for row, law in self.driven_velocities:
            found[self.row_places[row]] = self._of_time(law, t)
        return found

    def loads(self, poses, u, values):
        """Return applied and gyroscopic forces, shape (bodies, 6)."""
        found = np.zeros((self.n + 1, 6))
        for wrench in self.wrenches:
            found += forces.moment(wrench(poses, u, values), poses, self.n + 1)
        for k in range(self.n):
            tensor = poses.A[k] @ self.inertia[k] @ poses.A[k].T
            found[k, :3] += self.mass[k] * self.gravity
            found[k, 3:] -= cross(u[k, 3:], tensor @ u[k, 3:])
        return found

    def mass_matrix(self, poses):
        """Return M of all bodies, shape (6 bodies, 6 bodies)."""
        found = np.zeros((6 * self.n, 6 * self.n))
        for k in range(self.n):
            at = slice(6 * k, 6 * k + 3), slice(6 * k + 3, 6 * k + 6)
            found[at[0], at[0]] = self.mass[k] * np.eye(3)
            found[at[1], at[1]] = poses.A[k] @ self.inertia[k] @ poses.A[k].T
        return found[np.ix_(self.columns, self.columns)]

    def motion(self, state, t, load=None):
        """Return accelerations and smallest multipliers; `load` of shape (bodies, 6) is added to the forces."""
        poses, u = state.poses, state.u
        values = self._values(poses, u, state.s, t)
        f = self.loads(poses, u, values) + (0.0 if load is None else load)
        M = self.mass_matrix(poses)
        free = np.linalg.solve(M, f.ravel()[self.columns])
        a = np.zeros(6 * (self.n + 1))
        lam = np.zeros(0)
        if self.rows:
            J = self.jacobian(poses, t)[:, self.columns]
            gamma = -difference(lambda h: self.rate(poses.moved(u, h), u, t + h), TIME_STEP)
            inverse = np.linalg.solve(M, J.T)
            lam = np.linalg.lstsq(J @ inverse, J @ free - gamma, rcond=1e-11)[0]
            free = free - inverse @ lam
        a[self.columns] = free
        rates = np.concatenate([
            np.zeros(0),
            *(each.rates(state.s[p:q], values) for each, p, q in zip(self.linear, self.places[:-1], self.places[1:], strict=True)),
        ])  # fmt: skip
        return Motion(a.reshape(-1, 6), lam, rates, values)

    # --- channels

    def channels(self, state, t, load=None):
        """Return the channels of bodies, of joints between two markers and drives, and of states by the package's names."""
        motion = self.motion(state, t, load)
        found: dict[str, Any] = {}
        poses, u, a = state.poses, state.u, motion.a
        for name, k in list(self.index.items())[:-1]:
            if self.in_space:
                own = poses.A[k].T
                found |= dict(zip([f"{name}.{p}" for p in ("x", "y", "z")], poses.r[k], strict=True))
                spin, more = own @ u[k, 3:], own @ a[k, 3:]
                for labels, values in (("vx vy vz", u[k, :3]), ("wx wy wz", spin), ("ax ay az", a[k, :3]),
                                       ("alpha_x alpha_y alpha_z", more)):  # fmt: skip
                    found |= {f"{name}.{label}": part for label, part in zip(labels.split(), values, strict=True)}
            else:
                parts = (*poses.r[k, :2], self._channel(poses, u, name, "angle"), *u[k, [0, 1, 5]], *a[k, [0, 1, 5]])
                labels = "x y angle vx vy omega ax ay alpha"
                found |= {f"{name}.{label}": part for label, part in zip(labels.split(), parts, strict=True)}
        found |= self._reactions(state, t, motion)
        found |= {each.name: motion.values[each.name] for each in self.linear}
        found |= {name: motion.values[name] for name in self.algebraic}
        return found

    def _reactions(self, state, t, motion):
        if not self.rows:
            return {}
        poses, places = state.poses, self.row_places
        found: dict[str, Any] = {}
        J = self.jacobian(poses, t)
        for name, (first, last) in self.joint_rows.items():
            rows = slice(places[first], places[last])
            i, _ = self.pairs[name]
            force = -(J[rows, 6 * i.body : 6 * i.body + 6].T @ motion.lam[rows])
            torque = force[3:] - cross(i.at(poses) - poses.r[i.body], force[:3])
            if self.in_space:
                parts = dict(zip(("fx", "fy", "fz", "tx", "ty", "tz"), (*force[:3], *torque), strict=True))
            else:
                parts = {"fx": force[0], "fy": force[1], "torque": torque[2]}
            found |= {f"{name}.{label}": part for label, part in parts.items()}
        return found

    # --- a state from channels, and integration

    def state_of(self, channels):
        """Return the state with the poses and velocities of channels, and the states of rates."""
        r, A, u = self.start.poses.r.copy(), self.start.poses.A.copy(), np.zeros_like(self.start.u)
        for name, k in list(self.index.items())[:-1]:
            if self.in_space:
                r[k] = [channels[f"{name}.{p}"] for p in "xyz"]
                A[k] = of_quaternion([channels[f"{name}.q{p}"] for p in range(4)])
                u[k, :3] = [channels[f"{name}.v{p}"] for p in "xyz"]
                u[k, 3:] = A[k] @ np.array([channels[f"{name}.w{p}"] for p in "xyz"])
            else:
                r[k, :2] = [channels[f"{name}.{p}"] for p in "xy"]
                A[k] = about_z(channels[f"{name}.angle"])
                u[k, [0, 1, 5]] = [channels[f"{name}.{p}"] for p in ("vx", "vy", "omega")]
        s = np.zeros(int(self.places[-1]))
        for each, p in zip(self.linear, self.places[:-1], strict=True):
            own = [channels.get(f"{each.name}.{label}") for label in each.labels]
            if each.labels == ("",):
                s[p] = channels[each.name]
            elif None not in own:
                s[p : p + len(own)] = own
        return State(Poses(r, A), u, s)

    def settled(self, state, t=0.0):
        """Return the state with filters and linear systems at rest."""
        for _ in range(len(self.linear) + 1):
            values, s = self._values(state.poses, state.u, state.s, t), state.s.copy()
            for each, p in zip(self.linear, self.places[:-1], strict=True):
                if np.linalg.matrix_rank(each.a) == len(each.a):
                    s[p : p + len(each.a)] = np.linalg.solve(each.a, -each.b * each.input(values))
            state = replace(state, s=s)
        return state

    def packed(self, state):
        """Return a state as a vector."""
        return np.concatenate([state.poses.r[:-1].ravel(), state.poses.A[:-1].ravel(), state.u[:-1].ravel(), state.s])

    def unpacked(self, y):
        """Return the state of a vector."""
        n = self.n
        r, A, u = (
            y[a * n : b * n].reshape(shape) for a, b, shape in ((0, 3, (n, 3)), (3, 12, (n, 3, 3)), (12, 18, (n, 6)))
        )
        with_ground = Poses(np.vstack([r, np.zeros((1, 3))]), np.concatenate([A, np.eye(3)[None]]))
        return State(with_ground, np.vstack([u, np.zeros((1, 6))]), y[18 * n :])

    def run(self, state, t0, times, rtol=1e-11, inputs=None):
        """Integrate from t0 and return the states at the times, by DOP853."""

        def rates(t, y):
            now = self.unpacked(y)
            motion = self.motion(now, t)
            turning = np.array([np.cross(u[3:], A.T).T for u, A in zip(now.u[:-1], now.poses.A[:-1], strict=True)])
            return np.concatenate([now.u[:-1, :3].ravel(), turning.ravel(), motion.a[:-1].ravel(), motion.rates])

        found = solve_ivp(rates, (t0, times[-1]), self.packed(state), "DOP853", t_eval=times, rtol=rtol, atol=rtol / 10)
        return [self.unpacked(y) for y in found.y.T]

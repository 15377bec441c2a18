"""Suspensions as points and links in NumPy, which share no code with the package: their measures by finite differences.

A corner is an upright that is held by five equations; the sixth is the height of its contact, or the length of its strut.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

STEP = 1e-3


@dataclass(frozen=True)
class Corner:
    """Left suspension: points (inner, outer) of its links, or a strut whose top slides on a line of the upright."""

    links: tuple
    centre: np.ndarray
    strut: tuple  # seat and tower
    on_arm: tuple | None = None  # points of the lower arm that carries the seat: front, rear, ball
    slides: bool = False  # MacPherson
    toe_link: int = -1
    cache: dict = field(default_factory=dict, compare=False)

    def pose(self, rise, rack=0.0, length=None):
        """Return rotation and translation for a rise of the contact (or a strut length) and a travel of the rack."""
        key = (rise, rack, length)
        if key not in self.cache:
            self.cache[key] = self._solved(rise, rack, length)
        return self.cache[key]

    def _residual(self, x, rise, rack, length):
        rotation, moved = Rotation.from_rotvec(x[3:]).as_matrix(), x[:3]
        at = lambda point: self.centre + moved + rotation @ (np.asarray(point) - self.centre)  # noqa: E731
        found = []
        for k, (inner, outer) in enumerate(self.links):
            shift = np.array([0, rack if k == self.toe_link % len(self.links) else 0.0, 0])
            found.append(np.linalg.norm(at(outer) - inner - shift) - np.linalg.norm(np.subtract(outer, inner)))
        if self.slides:
            seat, tower = map(np.asarray, self.strut)
            line = rotation @ (tower - seat)
            off = np.cross(tower - at(seat), line)
            found += [off[0], off[1]]
        if length is None:
            found.append(self._contact(at(self.centre), rotation)[2] - rise)
        else:
            found.append(self._strut_length(at) - length)
        return np.array(found)

    def _solved(self, rise, rack, length):
        x = np.zeros(6)
        for _ in range(40):
            value = self._residual(x, rise, rack, length)
            steps = 1e-6 * np.eye(6)
            jacobian = np.stack([(self._residual(x + h, rise, rack, length) - self._residual(x - h, rise, rack, length)) / 2e-6 for h in steps], axis=1)  # fmt: skip
            x = x - np.linalg.solve(jacobian, value)
            if np.max(np.abs(value)) < 1e-15:
                break
        assert np.max(np.abs(self._residual(x, rise, rack, length))) < 1e-13
        return Rotation.from_rotvec(x[3:]).as_matrix(), x[:3]

    def point(self, point, *state, **more):
        rotation, moved = self.pose(*state, **more)
        return self.centre + moved + rotation @ (np.asarray(point) - self.centre)

    def _contact(self, centre, rotation):
        """The wheel's lowest point: it rolls, so that it does not turn with the upright."""
        axis = rotation[:, 1]
        down = np.array([0, 0, -1.0]) + axis[2] * axis
        return centre + self.centre[2] * down / np.linalg.norm(down)

    def contact(self, *state, **more):
        return self._contact(self.point(self.centre, *state, **more), self.pose(*state, **more)[0])

    def patch(self, *state, **more):
        """The point of the upright that is the contact as drawn: of a wheel that is locked on it."""
        return self.point(self.centre - [0, 0, self.centre[2]], *state, **more)

    def _strut_length(self, at):
        seat, tower = map(np.asarray, self.strut)
        if self.on_arm is None:
            return np.linalg.norm(at(seat) - tower)
        return np.linalg.norm(self._on_arm_at(seat, at) - tower)

    def _on_arm_at(self, point, at):
        front, rear, ball = map(np.asarray, self.on_arm)
        before, after = _frame(front, rear, ball), _frame(front, rear, at(ball))
        return front + after @ before.T @ (point - front)

    def on_arm_at(self, point, *state):
        """A point of the lower arm."""
        return self._on_arm_at(point, lambda outer: self.point(outer, *state))

    def length(self, *state):
        return self._strut_length(lambda point: self.point(point, *state))

    def axis(self, *state, **more):
        return self.pose(*state, **more)[0][:, 1]

    def toe(self, *state):
        x, y, _ = self.axis(*state)
        return np.degrees(np.arctan2(x, y))

    def camber(self, *state):
        return np.degrees(-np.arcsin(self.axis(*state)[2]))


def _frame(front, rear, ball):
    along = (front - rear) / np.linalg.norm(front - rear)
    normal = np.cross(along, ball - front)
    normal /= np.linalg.norm(normal)
    return np.stack([along, normal, np.cross(along, normal)], axis=1)


def slope(of, x, step=STEP):
    """Fourth-order central difference."""
    far, near = np.asarray(of(x + 2 * step)) - of(x - 2 * step), np.asarray(of(x + step)) - of(x - step)
    return (8 * near - far) / (12 * step)


def screw(corner, motion):
    """Return the axis of a motion about its middle: direction upwards and a point of it, from the rates of the pose."""
    middle = corner.point(corner.centre, *motion(0.0)[:2], **motion(0.0)[2])

    def state(s):
        rise, rack, more = motion(s)
        return corner.pose(rise, rack, **more), corner.point(corner.centre, rise, rack, **more)

    spin = slope(lambda s: state(s)[0][0], 0.0) @ state(0.0)[0][0].T
    omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    v = slope(lambda s: state(s)[1], 0.0)
    point = middle + np.cross(omega, v) / (omega @ omega)
    direction = omega / np.linalg.norm(omega)
    return direction * np.sign(direction[2]), point

"""Motion of markers, and measures between them: of numbers at one instant, or of arrays over time.

Both are written once, in components. The plane is the x-y plane of space.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property, partial
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from ..elements.requests.check import ends
from ..elements.requests.output import CONTINUOUS_ANGLES, Term
from ..reading.marker import GROUND, MarkerReference

if TYPE_CHECKING:
    from ..model.model_data import ModelData

Value = Any
"""A number, or an array of shape (n,)."""
Vector = tuple[Value, Value, Value]
Matrix = tuple[Vector, Vector, Vector]
"""Rows."""
Quaternion = tuple[Value, Value, Value, Value]


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> Value:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def plus(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def turned(matrix: Matrix, v: Vector) -> Vector:
    """Return matrix times vector."""
    return dot(matrix[0], v), dot(matrix[1], v), dot(matrix[2], v)


def rotation(p: Quaternion) -> Matrix:
    """Return the rotation matrix of a unit quaternion."""
    w, x, y, z = p
    return (
        (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )


def times(p: Quaternion, r: Quaternion) -> Quaternion:
    """Return the product of quaternions."""
    (a, *v), (b, *w) = p, r
    x, y, z = (a * w[k] + b * v[k] + c for k, c in enumerate(cross((*v,), (*w,))))
    return a * b - dot((*v,), (*w,)), x, y, z


def _vector(in_plane: str, in_space: str, in_own_axes: bool = False) -> cached_property[Vector]:
    """Return a vector of a body in ground axes, by its channels in the plane and those in space."""

    def found(body: BodyFrame) -> Vector:
        x, y, z = body.read(in_plane if body.planar else in_space)
        return turned(body.matrix, (x, y, z)) if in_own_axes and not body.planar else (x, y, z)

    return cached_property(found)


class BodyFrame:
    """Centre of mass of a body with the body's own axes; each part is read when it is needed.

    `read`: returns channels of the body, given their names; ``0`` stands for zero. `maths`: module of the functions.
    """

    def __init__(self, read: Callable[[str], tuple[Value, ...]], planar: bool, maths: ModuleType) -> None:
        self.read, self.planar, self._maths = read, planar, maths

    @cached_property
    def quaternion(self) -> Quaternion:
        """Quaternion of the axes."""
        if self.planar:
            (angle,) = self.read("angle")
            return self._maths.cos(angle / 2), 0.0, 0.0, self._maths.sin(angle / 2)
        w, x, y, z = self.read("q0 q1 q2 q3")
        return w, x, y, z

    @cached_property
    def matrix(self) -> Matrix:
        """Rotation matrix, with the axes as columns."""
        if self.planar:
            (angle,) = self.read("angle")
            c, s = self._maths.cos(angle), self._maths.sin(angle)
            return (c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)
        return rotation(self.quaternion)

    point = _vector("x y 0", "x y z")
    """Position, m."""
    velocity = _vector("vx vy 0", "vx vy vz")
    """Velocity, m/s."""
    acceleration = _vector("ax ay 0", "ax ay az")
    """Acceleration, m/s^2."""
    omega = _vector("0 0 omega", "wx wy wz", in_own_axes=True)
    """Angular velocity, rad/s."""
    alpha = _vector("0 0 alpha", "wdx wdy wdz", in_own_axes=True)
    """Angular acceleration, rad/s^2."""


class GroundFrame(BodyFrame):
    """Ground, at rest."""

    def __init__(self) -> None:
        super().__init__(lambda names: (0.0,) * len(names.split()), True, math)


class MarkerFrame:
    """Marker of a body.

    `point`: from the centre of mass in the body's own axes, m. `orientation`: quaternion of the marker's axes in those
    of the body.
    """

    def __init__(self, body: BodyFrame, point: Vector, orientation: Quaternion) -> None:
        self._body, self._point, self._orientation = body, point, orientation

    @cached_property
    def _arm(self) -> Vector:
        return turned(self._body.matrix, self._point)

    @cached_property
    def axes(self) -> Matrix:
        """Unit axes in ground axes."""
        by_rows, own = self._body.matrix, rotation(self._orientation)
        x, y, z = (turned(by_rows, (own[0][k], own[1][k], own[2][k])) for k in range(3))
        return x, y, z

    @property
    def quaternion(self) -> Quaternion:
        """Quaternion of the axes."""
        return times(self._body.quaternion, self._orientation)

    @property
    def point(self) -> Vector:
        """Position, m."""
        return plus(self._body.point, self._arm)

    @property
    def velocity(self) -> Vector:
        """Velocity, m/s."""
        return plus(self._body.velocity, cross(self._body.omega, self._arm))

    @property
    def acceleration(self) -> Vector:
        """Acceleration, m/s^2."""
        omega, arm = self._body.omega, self._arm
        turning = plus(cross(self._body.alpha, arm), cross(omega, cross(omega, arm)))
        return plus(self._body.acceleration, turning)

    @property
    def omega(self) -> Vector:
        """Angular velocity, rad/s."""
        return self._body.omega

    @property
    def alpha(self) -> Vector:
        """Angular acceleration, rad/s^2."""
        return self._body.alpha


def place(model: ModelData, marker: MarkerReference) -> tuple[np.ndarray, np.ndarray]:
    """Return the position of a marker relative to the centre of mass, and the quaternion of its axes in the body's."""
    placed = model.place(marker)
    if model.dimensions == 2:
        half = placed.angle / 2
        return np.array([*placed.point, 0.0]), np.array([math.cos(half), 0.0, 0.0, math.sin(half)])
    point = np.array(placed.point)
    if marker.body != GROUND:
        point = point - model.bodies[marker.body].center_of_mass
    return point, np.array(placed.orientation)


_GROUND = GroundFrame()
ALIGNED = 1e-12
"""Sine of the angle between two z axes below which they count as parallel."""
VECTORS = {"d": "point", "v": "velocity", "w": "omega", "acc": "acceleration", "wdt": "alpha"}
"""Vectors of a marker whose differences are measures, by the name of their components without the last letter."""


def _distance_rate(i: MarkerFrame, j: MarkerFrame, maths: ModuleType) -> Value:
    offset = minus(i.point, j.point)
    return dot(offset, minus(i.velocity, j.velocity)) / maths.sqrt(dot(offset, offset))


def _psi(i: MarkerFrame, j: MarkerFrame, _: ModuleType) -> Value:
    """Return the first Euler angle of the sequence z, x, z; if the z axes are parallel, it is the whole rotation."""
    (x, y, _z), along_x = turned(j.axes, i.axes[2]), turned(j.axes, i.axes[0])
    whole = np.arctan2(along_x[1], along_x[0])
    return np.where(np.hypot(x, y) > ALIGNED, np.arctan2(x, -y), whole)[()]


def _theta(i: MarkerFrame, j: MarkerFrame, maths: ModuleType) -> Value:
    x, y, z = turned(j.axes, i.axes[2])
    return maths.atan2(maths.hypot(x, y), z)


def _phi(i: MarkerFrame, j: MarkerFrame, _: ModuleType) -> Value:
    x, y, _z = turned(i.axes, j.axes[2])
    return np.where(np.hypot(x, y) > ALIGNED, np.arctan2(x, y), 0.0)[()]


def _quaternion(k: int, i: MarkerFrame, j: MarkerFrame, _: ModuleType) -> Value:
    """Return a component of the quaternion of the axes of i in those of j."""
    w, x, y, z = j.quaternion
    return times((w, -x, -y, -z), i.quaternion)[k]


SCALARS: dict[str, Callable[[MarkerFrame, MarkerFrame, ModuleType], Value]] = {
    "vr": _distance_rate, "psi": _psi, "theta": _theta, "phi": _phi, **{f"q{k}": partial(_quaternion, k) for k in range(4)},
}  # fmt: skip
"""Scalar measures."""


class Measures:
    """Measures between the markers of a model, and components of actions of its joints and forces.

    `read`: returns a channel. `counter`: returns the revolution counter of an angle, by the text of the angle. `maths`: module
    of the functions, `math` for numbers and NumPy for arrays.
    """

    def __init__(
        self, model: ModelData, read: Callable[[str], Value], counter: Callable[[str], Value], maths: ModuleType
    ) -> None:
        self._model, self._read_channel, self._counter, self._maths = model, read, counter, maths
        self._planar = model.dimensions == 2
        self._placed: dict[int, tuple[MarkerReference, Any, Any]] = {}
        self.forget()

    def forget(self) -> None:
        """Discard the values of an earlier instant."""
        self._bodies: dict[str, BodyFrame] = {GROUND: _GROUND}
        self._markers: dict[int, MarkerFrame] = {}

    def marker(self, marker: MarkerReference) -> MarkerFrame:
        """Return the motion of a marker."""
        at = id(marker)  # hashing the marker would take longer
        if at not in self._markers:
            if at not in self._placed:
                point, orientation = place(self._model, marker)
                self._placed[at] = marker, tuple(point.tolist()), tuple(orientation.tolist())
            body = marker.body
            if body not in self._bodies:
                self._bodies[body] = BodyFrame(partial(self._read, body), self._planar, self._maths)
            self._markers[at] = MarkerFrame(self._bodies[body], *self._placed[at][1:])
        return self._markers[at]

    def value(self, term: Term) -> Value:
        """Return a measure between markers, or a component of an action."""
        if term.element:
            return self._action(term)
        i, j, *axes = (self.marker(marker) for marker in term.markers)
        name = term.function
        if name in CONTINUOUS_ANGLES:
            return self._continuous_angle(term, i, j)
        if name in SCALARS:
            return SCALARS[name](i, j, self._maths)
        level = VECTORS[name[:-1]]
        return self._component(minus(getattr(i, level), getattr(j, level)), name[-1], axes)

    def _component(self, v: Vector, which: str, axes: list[MarkerFrame]) -> Value:
        """Return the magnitude of a vector, or its component along the axes of a marker or of ground."""
        if which == "m":
            return self._maths.sqrt(dot(v, v))
        k = "xyz".index(which)
        return dot(v, axes[0].axes[k]) if axes else v[k]

    def _read(self, owner: str, labels: str) -> tuple[Value, ...]:
        """Return channels of a body or element; the label 0 stands for zero."""
        return tuple(0.0 if label == "0" else self._read_channel(f"{owner}.{label}") for label in labels.split())

    def _action(self, term: Term) -> Value:
        """Return a component of a force or torque on the first or second body of an element."""
        labels = ("fx fy 0", "0 0 torque") if self._planar else ("fx fy fz", "tx ty tz")
        force, torque = ((x, y, z) for x, y, z in (self._read(term.element, own) for own in labels))
        if term.on_second:
            i, j = (self.marker(marker).point for marker in ends(term.element, self._model))
            torque = minus((0.0, 0.0, 0.0), plus(torque, cross(minus(i, j), force)))
            force = minus((0.0, 0.0, 0.0), force)
        acting = force if term.function[0] == "f" else torque
        return self._component(acting, term.function[1], [self.marker(marker) for marker in term.markers])

    def _continuous_angle(self, term: Term, i: MarkerFrame, j: MarkerFrame) -> Value:
        """Return an unwrapped angle: of planar bodies, or in space by its revolution counter."""
        if self._planar:
            one, other = (
                self._model.place(marker).angle
                + (0.0 if marker.body == GROUND else self._read(marker.body, "angle")[0])
                for marker in term.markers
            )
            return one - other
        about = term.function[1]
        if about == "z":
            sine, cosine = dot(i.axes[0], j.axes[1]), dot(i.axes[0], j.axes[0])
        else:
            z = i.axes[2]
            sine, cosine = -dot(z, j.axes[1]) if about == "x" else dot(z, j.axes[0]), dot(z, j.axes[2])
        counted = self._counter(str(term))
        s, c = self._maths.sin(counted), self._maths.cos(counted)
        return counted + self._maths.atan2(sine * c - cosine * s, cosine * c + sine * s)

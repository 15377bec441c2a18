"""Construction of a random scene."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stiffmbs.elements.spatial.orientation import from_matrix

from .features import ALL, Features

Content = dict[str, Any]
GROUND = "ground"
ROUNDING = 1e-15


class Unfit(Exception):
    """The draft has nothing on which an element of this kind could act."""


@dataclass(frozen=True)
class Pose:
    """Point in ground axes, and axes as the columns of a rotation matrix."""

    point: np.ndarray
    axes: np.ndarray


@dataclass(frozen=True)
class Coordinate:
    """Coordinate of a joint that relations and drives may use.

    Attributes
    ----------
    joint : str
        Name in relations; ``sleeve.angle`` if the joint has two coordinates.
    sort : str
        ``angle`` or ``displacement``.
    i, j : str
        Names of the bodies.
    """

    joint: str
    sort: str
    i: str
    j: str


@dataclass
class Draft:
    """Random scene under construction.

    Attributes
    ----------
    rng : Generator
    dimensions : int
    features : Features
        Features that it may have.
    content : dict
        Content of the scene file.
    poses : dict of str to Pose
        Poses of the body axes and of the ground.
    coordinates : list of Coordinate
        Coordinates not yet used by a relation or drive.
    freedoms : int
        Number of remaining degrees of freedom.
    """

    rng: np.random.Generator
    dimensions: int
    features: Features = ALL
    content: Content = field(default_factory=dict)
    poses: dict[str, Pose] = field(default_factory=lambda: {GROUND: Pose(np.zeros(3), np.eye(3))})
    coordinates: list[Coordinate] = field(default_factory=list)
    freedoms: int = 0

    @property
    def in_space(self) -> bool:
        """True for spatial scenes."""
        return self.dimensions == 3

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
        return [name for name in self.poses if name != GROUND]

    def section(self, name: str) -> Content:
        """Return a section of the scene, which is created if necessary."""
        found: Content = self.content.setdefault(name, {})
        return found

    def add(self, section: str, name: str, **fields: Any) -> str:
        """Add an entry to a section and return its name, which is made unique."""
        entries = self.section(section)
        taken = {*self.section("joints"), *self.section("forces"), *self.section("states"), *self.poses, *entries}
        unique = next(each for each in (f"{name}{k}" for k in range(len(taken) + 1)) if each not in taken)
        entries[unique] = {key: value for key, value in fields.items() if value is not None}
        return unique

    def chance(self, probability: float) -> bool:
        """Return True with a probability."""
        return bool(self.rng.random() < probability)

    def uniform(self, low: float, high: float) -> float:
        """Return a random number of three digits, so that scenes are readable."""
        return float(f"{self.rng.uniform(low, high):.3g}")

    def vector(self, size: float, count: int | None = None) -> list[float]:
        """Return random components of a planar or spatial vector."""
        return [self.uniform(-size, size) for _ in range(count or self.dimensions)]

    def place(self, size: float) -> np.ndarray:
        """Return a random vector of three components, the third of which is zero in the plane."""
        return np.array([*self.vector(size), 0.0][:3])

    def choice(self, options: Any) -> Any:
        """Return one of some options."""
        options = list(options)
        if not options:
            raise Unfit
        return options[int(self.rng.integers(len(options)))]

    def two_bodies(self) -> tuple[str, str]:
        """Return two bodies, the second of which may be the ground."""
        first = self.choice(self.bodies)
        return first, self.choice(name for name in self.poses if name != first)

    def axes(self) -> np.ndarray:
        """Return random axes: about the normal in the plane, often those of the ground."""
        if self.chance(0.3):
            return np.eye(3)
        if not self.in_space:
            return about_z(self.uniform(-3, 3))
        return random_axes(self.rng)

    def marker(self, body: str, at: np.ndarray, axes: np.ndarray | None = None) -> Content:
        """Return a marker of a body at a point in ground axes, with the axes of the ground or others."""
        pose = self.poses[body]
        own = pose.axes.T @ (at - pose.point)
        own[np.abs(own) < ROUNDING] = 0.0
        along = np.eye(3) if axes is None else axes
        found: Content = {"body": body, "point": own[: self.dimensions].tolist()}
        if self.in_space:
            return {**found, "orientation": [float(part) for part in from_matrix(pose.axes.T @ along)]}
        return {**found, "angle": _angle(along) - _angle(pose.axes)}

    def near(self, body: str, size: float = 0.3) -> np.ndarray:
        """Return a point near a body's origin, or near the ground's."""
        return self.poses[body].point + self.place(size)

    def slide(self, axes: np.ndarray) -> np.ndarray:
        """Return the direction in which joints slide: x of markers in the plane, z in space."""
        return axes[:, 2 if self.in_space else 0]


def about_z(angle: float) -> np.ndarray:
    """Return axes rotated about z."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def about_x(angle: float) -> np.ndarray:
    """Return axes rotated about x."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def random_axes(rng: np.random.Generator) -> np.ndarray:
    """Return randomly rotated axes."""
    w, x, y, z = (part / 1.0 for part in _unit(rng.standard_normal(4)))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def axes_with_z(direction: np.ndarray) -> np.ndarray:
    """Return axes whose z is a direction."""
    z = direction / np.linalg.norm(direction)
    x = np.cross([0.0, 1.0, 0.0] if abs(z[0]) > abs(z[1]) else [1.0, 0.0, 0.0], z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def _angle(axes: np.ndarray) -> float:
    """Return the angle of x about z, so that parallel markers have the same angle without whole turns."""
    return math.atan2(axes[1, 0], axes[0, 0])


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v)

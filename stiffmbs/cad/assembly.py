"""Assembly: the common content of the files of CAD programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..elements.spatial.massless import BEYOND
from ..elements.spatial.orientation import ROUGH, UNIT, from_matrix
from ..reading.files.xml_nodes import FileFault
from ..reading.files.yaml_text import Content
from ..robots.pose import Placed
from ..robots.robot import Link

PARALLEL = 1e-9
"""Largest sine of the angle between directions that count as parallel."""
LARGEST = 1e100
"""Largest number of a file."""


class CadFault(FileFault):
    """Invalid or unsupported content of an assembly; the message names the part, mate or joint."""


@dataclass(frozen=True)
class Frame:
    """Frame in the world: `position` of shape (3,), m; the columns of `axes`, shape (3, 3), are its axes."""

    position: np.ndarray
    axes: np.ndarray

    def within(self, outer: Frame) -> Frame:
        """Return this frame in the axes of another."""
        return Frame(outer.axes.T @ (self.position - outer.position), outer.axes.T @ self.axes)

    def on(self, outer: Frame) -> Frame:
        """Return this frame, given in the axes of another, in the world."""
        return Frame(outer.position + outer.axes @ self.position, outer.axes @ self.axes)


WORLD = Frame(np.zeros(3), np.eye(3))


@dataclass(frozen=True)
class Part:
    """Rigid part: mass, centre of mass and inertia in its frame, the pose of the frame, and velocities.

    `velocity` of its origin, m/s, and `omega`, rad/s, both of shape (3,) in ground axes.
    """

    name: str
    link: Link
    frame: Frame
    velocity: np.ndarray = field(default_factory=lambda: np.zeros(3))
    omega: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @property
    def placed(self) -> Placed:
        """Pose and velocities as those of a robot's link."""
        return Placed(self.frame.position, from_matrix(self.frame.axes), self.velocity, self.omega)


@dataclass(frozen=True)
class Seat:
    """Frame on a part, in the part's axes; on ground without a part."""

    part: str | None
    frame: Frame


@dataclass(frozen=True)
class Tie:
    """Joint of the scene between two parts. `kind`: kind of the joint; `fields`: its other entries.

    `equation`: for the kind `equation`, a formula in which ``{i}`` and ``{j}`` stand for the markers, and other names in
    braces for the further markers `others`.
    """

    name: str
    kind: str
    i: Seat
    j: Seat
    fields: Mapping[str, object] = field(default_factory=dict)
    equation: str = ""
    others: Mapping[str, Seat] = field(default_factory=dict)


@dataclass(frozen=True)
class Assembly:
    """Parts with the joints between them.

    `gravity`: m/s^2. `drives`: by name, the joint, its coordinate such as ``.angle`` or nothing, and the position as a
    formula. `run`: settings of the run. `notes`: omitted content.
    """

    name: str
    parts: tuple[Part, ...]
    ties: tuple[Tie, ...]
    gravity: tuple[float, ...]
    run: Content
    drives: Mapping[str, tuple[str, str, str]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def at_angle(name: str, i: Seat, j: Seat, cosine: float) -> Tie:
    """Return the joint that keeps the cosine of the angle between two z axes.

    Its formula is the component along the z axis of j of the unit vector from i to a point on the z axis of i.
    """
    if abs(cosine) < PARALLEL:
        return Tie(name, "perpendicular", i, j)
    if 1 - abs(cosine) < PARALLEL**2:
        return Tie(name, "parallel", i, j)
    tip = Seat(i.part, Frame(i.frame.position + i.frame.axes[:, 2], i.frame.axes))
    return Tie(name, "equation", i, j, equation=f"dz({{tip}}, {{i}}, {{j}}) - {cosine!r}", others={"tip": tip})


def off_axis(name: str, i: Seat, j: Seat, distance: float) -> Tie:
    """Return the joint that keeps the distance, m, of the point of i from the z axis of j."""
    if distance == 0:
        return Tie(name, "point_on_line", i, j)
    formula = f"sqrt(dx({{i}}, {{j}}, {{j}})^2 + dy({{i}}, {{j}}, {{j}})^2) - {distance!r}"
    return Tie(name, "equation", i, j, equation=formula)


def finite(where: str, values: np.ndarray) -> np.ndarray:
    """Return numbers of a file; raise CadFault for some that are too large to compute with."""
    if np.any(np.abs(values) > LARGEST):
        raise CadFault(f"{where}: {BEYOND}")
    return values


def rotation(where: str, values: np.ndarray) -> np.ndarray:
    """Return the rotation matrix nearest to a given one, shape (3, 3).

    Raises CadFault if it departs from a rotation by more than rounding to four digits, such as a mirror image.
    """
    is_near = np.all(np.abs(values) < 2) and np.max(np.abs(values @ values.T - np.eye(3))) <= ROUGH
    if not is_near or np.linalg.det(values) < 0:
        rows = "; ".join(" ".join(f"{x:.4g}" for x in row) for row in values)
        raise CadFault(f"{where}: found the rows {rows}, expected a rotation matrix")
    left, _, right = np.linalg.svd(values)
    nearest: np.ndarray = left @ right
    return nearest if np.max(np.abs(nearest - values)) > UNIT else values


def axes_along(z: np.ndarray) -> np.ndarray:
    """Return axes, as the columns of a matrix, whose z axis has a direction."""
    least = np.eye(3)[np.argmin(np.abs(z))]
    x = np.cross(least, z)
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])

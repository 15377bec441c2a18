"""Frames of spatial parts: placement and mirroring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, Self

import numpy as np
from pydantic import Field

from ..parts.use import Use
from .body import Body
from .marker import ORIGIN, Point
from .orientation import AXES, IDENTITY, Orientation, Quaternion, about, conjugate, matrix, product, rotated

STRAIGHT = 1e-12
"""Largest off-diagonal entry of the mirror in ground axes that is parallel to them."""


class SpatialUse(Use):
    """Part placed in space.

    Parameters
    ----------
    position, orientation
        Position (m) and orientation of the part's frame in the axes of its mount, from that body's origin.
    mirror : str, optional
        Coordinate of the part's frame, x, y or z, that changes its sign.
    """

    position: Point = Field(ORIGIN, description="of the part's frame on its mount, m")
    orientation: Orientation = Field(IDENTITY, description="of the part's frame on its mount")
    mirror: Literal["x", "y", "z"] | None = Field(
        None, description="the coordinate of the part's frame that changes its sign"
    )


@dataclass(frozen=True)
class SpatialFrame:
    """Transformation of a point x of a part to p + A S x: S changes signs of coordinates, A rotates.

    Each frame X within a mirrored part, of a body or a marker, becomes S X S and remains right-handed. Along all of
    these axes the k-th component of a force changes its sign by S_kk, and that of a torque or rotation by det S S_kk.

    Attributes
    ----------
    point : triple of float
        p, m.
    orientation : quaternion
        Orientation of A.
    signs : triple of float
        Diagonal of S.
    """

    point: tuple[float, ...] = ORIGIN
    orientation: Quaternion = IDENTITY
    signs: tuple[float, ...] = (1.0, 1.0, 1.0)

    @classmethod
    def of_use(cls, use: Any) -> Self:
        """Return the placement and mirroring of a use."""
        assert isinstance(use, SpatialUse)
        return cls(use.position, use.orientation, tuple(-1.0 if use.mirror == axis else 1.0 for axis in AXES))

    @classmethod
    def of_body(cls, body: Any) -> Self:
        """Return the frame of a body in ground axes."""
        return cls(body.position, body.orientation)

    @property
    def handedness(self) -> float:
        """Determinant of S: 1, or -1 for a mirror image."""
        return math.prod(self.signs)

    @property
    def rotation_signs(self) -> tuple[float, ...]:
        """Signs of rotations about the axes."""
        return tuple(self.handedness * sign for sign in self.signs)

    def mirror(self) -> Self:
        """Return the mirror alone, which applies to points and axes in the axes of a mirrored body."""
        return type(self)(signs=self.signs)

    def inverse(self) -> Self:
        """Return the inverse transformation; the frame must not be mirrored."""
        back = conjugate(self.orientation)
        return type(self)(tuple(-float(part) for part in rotated(back, self.point)), back)

    def then(self, inner: SpatialFrame) -> Self:
        """Return the frame of a nested part."""
        signs = tuple(a * b for a, b in zip(self.signs, inner.signs, strict=True))
        return type(self)(self.to_outside(inner.point), self.oriented(inner.orientation), signs)

    def to_outside(self, x: tuple[float, ...]) -> tuple[float, ...]:
        """Transform a point of the part to the outer axes."""
        return tuple(p + d for p, d in zip(self.point, self.turned(x), strict=True))

    def turned(self, v: tuple[float, ...]) -> tuple[float, ...]:
        """Transform a vector of the part to the outer axes."""
        mirrored = tuple(sign * part for sign, part in zip(self.signs, v, strict=True))
        if self.orientation == IDENTITY:
            return mirrored
        return tuple(float(part) for part in rotated(self.orientation, mirrored))

    def oriented(self, p: Quaternion) -> Quaternion:
        """Transform an orientation in the part to the outer axes."""
        return product(self.orientation, (p[0], *self._as_rotation(p[1:])))

    def _as_rotation(self, v: tuple[float, ...]) -> Any:
        return tuple(sign * part for sign, part in zip(self.rotation_signs, v, strict=True))

    def placed(self, marker: Any) -> Any:
        """Return a marker or a placement in the outer axes."""
        update = {"point": self.to_outside(marker.point), "orientation": self.oriented(marker.orientation)}
        return marker.model_copy(update=update)

    def half_turned(self, marker: Any, axis: str) -> Any:
        """Return a marker with an axis reversed, rotated about the next one."""
        turn = about((AXES.index(axis) + 1) % 3, math.pi)
        return marker.model_copy(update={"orientation": product(marker.orientation, turn)})

    def placed_body(self, body: Body) -> Body:
        """Return a body of the part in ground axes."""
        own = self.mirror()
        inertia = np.outer(self.signs, self.signs) * np.array(body.inertia)
        return body.model_copy(
            update={
                "position": self.to_outside(body.position),
                "orientation": self.oriented(body.orientation),
                "velocity": self.turned(body.velocity),
                "omega": self._as_rotation(body.omega),
                "center_of_mass": own.turned(body.center_of_mass),
                "inertia": tuple(tuple(float(part) for part in row) for row in inertia),
                "markers": {name: own.placed(marker) for name, marker in body.markers.items()},
                "geometry": tuple(shape.placed(own) for shape in body.geometry),
            }
        )

    def ground_signs(self) -> tuple[float, ...] | None:
        """Return the signs of components along ground axes; None if the mirror is oblique to them."""
        A = matrix(self.orientation)
        whole = A @ np.diag(self.signs) @ A.T
        straight = np.max(np.abs(whole - np.diag(np.diag(whole)))) < STRAIGHT
        return tuple(float(np.sign(part)) for part in np.diag(whole)) if straight else None

"""Frames of spatial parts: placement and mirroring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, Self

import numpy as np
from pydantic import Field

from ...elements.spatial.body import Body
from ...elements.spatial.marker import ORIGIN, Point
from ...elements.spatial.orientation import (
    AXES,
    IDENTITY,
    Orientation,
    Quaternion,
    about,
    conjugate,
    matrix,
    product,
    rotated,
)
from .frame import Frame, Use


class SpatialUse(Use):
    """Part placed in space.

    `position`, `orientation`: position (m) and orientation of the part's frame in the axes of its mount, from that
    body's origin. `mirror`: coordinate of the part's frame, x, y or z, that changes its sign.
    """

    position: Point = Field(ORIGIN, description="of the part's frame on its mount, m")
    orientation: Orientation = Field(IDENTITY, description="of the part's frame on its mount")
    mirror: Literal["x", "y", "z"] | None = Field(
        None, description="the coordinate of the part's frame that changes its sign"
    )


@dataclass(frozen=True)
class SpatialFrame(Frame):
    """Frame of a spatial part, with the quaternion of its rotation."""

    point: tuple[float, ...] = ORIGIN
    signs: tuple[float, ...] = (1.0, 1.0, 1.0)
    orientation: Quaternion = IDENTITY

    @classmethod
    def of_use(cls, use: object) -> Self:
        """Return the placement and mirroring of a use."""
        assert isinstance(use, SpatialUse)
        return cls(use.position, tuple(-1.0 if use.mirror == axis else 1.0 for axis in AXES), use.orientation)

    @classmethod
    def of_body(cls, body: Body) -> Self:
        """Return the frame of a body in ground axes."""
        return cls(body.position, orientation=body.orientation)

    @property
    def rotation_signs(self) -> tuple[float, ...]:
        """Signs of rotations about the axes."""
        return tuple(self.handedness * sign for sign in self.signs)

    @property
    def rotation(self) -> np.ndarray:
        return matrix(self.orientation)

    def inverse(self) -> Self:
        """Return the inverse transformation; the frame must not be mirrored."""
        back = conjugate(self.orientation)
        return type(self)(tuple(-float(part) for part in rotated(back, self.point)), orientation=back)

    def then(self, inner: SpatialFrame) -> Self:
        """Return the frame of a nested part."""
        return type(self)(self.to_outside(inner.point), self.nested_signs(inner), self.oriented(inner.orientation))

    def turned(self, v: tuple[float, ...]) -> tuple[float, ...]:
        mirrored = tuple(sign * part for sign, part in zip(self.signs, v, strict=True))
        if self.orientation == IDENTITY:
            return mirrored
        return tuple(float(part) for part in rotated(self.orientation, mirrored))

    def oriented(self, p: Quaternion) -> Quaternion:
        """Transform an orientation in the part to the outer axes."""
        return product(self.orientation, (p[0], *self.turned_rate(p[1:])))

    def turned_rate(self, v: tuple[float, ...]) -> tuple[float, ...]:
        """Transform an angular velocity in the axes of a body of the part to those of the placed body."""
        return tuple(sign * part for sign, part in zip(self.rotation_signs, v, strict=True))

    def placed(self, marker: Any) -> Any:
        update = {"point": self.to_outside(marker.point), "orientation": self.oriented(marker.orientation)}
        return marker.model_copy(update=update)

    def half_turned(self, marker: Any, axis: str) -> Any:
        """Return a marker with an axis reversed, rotated about the next one."""
        turn = about((AXES.index(axis) + 1) % 3, math.pi)
        return marker.model_copy(update={"orientation": product(marker.orientation, turn)})

    def placed_inertia(self, body: Body) -> dict[str, object]:
        """Return the fields of a body that depend on the frame: axes, omega, centre of mass and inertia."""
        inertia = np.outer(self.signs, self.signs) * np.array(body.inertia)
        return {
            "orientation": self.oriented(body.orientation),
            "omega": self.turned_rate(body.omega),
            "center_of_mass": self.mirror().turned(body.center_of_mass),
            "inertia": tuple(tuple(float(part) for part in row) for row in inertia),
        }

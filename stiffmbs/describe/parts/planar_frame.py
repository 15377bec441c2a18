"""Frames of planar parts: placement and mirroring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

from ..body import Body
from .use import PlanarUse

STRAIGHT = 1e-12
"""Tolerance of the cosine of an angle between parallel axes."""


@dataclass(frozen=True)
class PlanarFrame:
    """Transformation of a point x of a part to p + A S x: S changes signs of coordinates, A rotates by an angle.

    Each frame X within a mirrored part, of a body or a marker, becomes S X S and remains right-handed. Along all of
    these axes the k-th component of a force changes its sign by S_kk, and rotations change theirs by det S.

    Attributes
    ----------
    point : pair of float
        p, m.
    angle : float
        rad.
    signs : pair of float
        Diagonal of S.
    """

    point: tuple[float, float] = (0.0, 0.0)
    angle: float = 0.0
    signs: tuple[float, float] = (1.0, 1.0)

    @classmethod
    def of_use(cls, use: Any) -> Self:
        """Return the placement and mirroring of a use."""
        assert isinstance(use, PlanarUse)
        return cls(use.position, use.angle, (-1.0 if use.mirror == "x" else 1.0, -1.0 if use.mirror == "y" else 1.0))

    @classmethod
    def of_body(cls, body: Any) -> Self:
        """Return the frame of a body in ground axes."""
        return cls(body.position, body.angle)

    @property
    def handedness(self) -> float:
        """Determinant of S: 1, or -1 for a mirror image."""
        return self.signs[0] * self.signs[1]

    @property
    def rotation_signs(self) -> tuple[float, ...]:
        """Signs of rotations about the axes."""
        return (self.handedness,)

    def mirror(self) -> Self:
        """Return the mirror alone, which applies to points and axes in the axes of a mirrored body."""
        return type(self)(signs=self.signs)

    def inverse(self) -> Self:
        """Return the inverse transformation; the frame must not be mirrored."""
        x, y = type(self)(angle=-self.angle).turned(self.point)
        return type(self)((-x, -y), -self.angle)

    def then(self, inner: PlanarFrame) -> Self:
        """Return the frame of a nested part."""
        signs = self.signs[0] * inner.signs[0], self.signs[1] * inner.signs[1]
        return type(self)(self.to_outside(inner.point), self.angle + self.handedness * inner.angle, signs)

    def to_outside(self, x: tuple[float, float]) -> tuple[float, float]:
        """Transform a point of the part to the outer axes."""
        dx, dy = self.turned(x)
        return self.point[0] + dx, self.point[1] + dy

    def turned(self, v: tuple[float, float]) -> tuple[float, float]:
        """Transform a vector of the part to the outer axes."""
        c, s = (math.cos(self.angle), math.sin(self.angle)) if self.angle else (1.0, 0.0)
        x, y = self.signs[0] * v[0], self.signs[1] * v[1]
        return c * x - s * y, s * x + c * y

    def placed(self, marker: Any) -> Any:
        """Return a marker or a placement in the outer axes."""
        angle = self.angle + self.handedness * marker.angle
        return marker.model_copy(update={"point": self.to_outside(marker.point), "angle": angle})

    def half_turned(self, marker: Any, axis: str) -> Any:
        """Return a marker with an axis reversed."""
        return marker.model_copy(update={"angle": marker.angle + math.pi})

    def placed_body(self, body: Body) -> Body:
        """Return a body of the part in ground axes."""
        own = self.mirror()
        return body.model_copy(
            update={
                "position": self.to_outside(body.position),
                "angle": self.angle + self.handedness * body.angle,
                "velocity": self.turned(body.velocity),
                "omega": self.handedness * body.omega,
                "markers": {name: own.placed(marker) for name, marker in body.markers.items()},
                "geometry": tuple(shape.placed(own) for shape in body.geometry),
            }
        )

    def ground_signs(self) -> tuple[float, ...] | None:
        """Return the signs of components along ground axes; None if the mirror is oblique to them."""
        c, s = math.cos(self.angle) ** 2, math.sin(self.angle) ** 2
        x, y = c * self.signs[0] + s * self.signs[1], s * self.signs[0] + c * self.signs[1]  # of A S A^T
        straight = min(abs(x), abs(y)) > 1 - STRAIGHT
        return (math.copysign(1.0, x), math.copysign(1.0, y)) if straight else None

"""Frames of planar parts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, Self

import numpy as np
from pydantic import Field

from ...elements.body import Body
from ...reading.units import si
from .frame import Frame, Use


class PlanarUse(Use):
    """Part placed in the plane.

    `position`, `angle`: position (m) and angle (rad) of the part's frame in the axes of its mount, from that body's
    centre of mass. `mirror`: coordinate of the part's frame, x or y, that changes its sign.
    """

    position: si.Point2 = Field((0.0, 0.0), description="of the part's frame on its mount, m")
    angle: si.Angle = Field(0.0, description="of the part's frame on its mount, rad")
    mirror: Literal["x", "y"] | None = Field(
        None, description="the coordinate of the part's frame that changes its sign"
    )


@dataclass(frozen=True)
class PlanarFrame(Frame):
    """Frame of a planar part, rotated by an angle, rad."""

    point: tuple[float, ...] = (0.0, 0.0)
    signs: tuple[float, ...] = (1.0, 1.0)
    angle: float = 0.0

    @classmethod
    def of_use(cls, use: object) -> Self:
        """Return the placement and mirroring of a use."""
        assert isinstance(use, PlanarUse)
        return cls(use.position, tuple(-1.0 if use.mirror == axis else 1.0 for axis in "xy"), use.angle)

    @classmethod
    def of_body(cls, body: Body) -> Self:
        """Return the frame of a body in ground axes."""
        return cls(body.position, angle=body.angle)

    @property
    def rotation_signs(self) -> tuple[float, ...]:
        """Signs of rotations about the axes."""
        return (self.handedness,)

    @property
    def rotation(self) -> np.ndarray:
        c, s = math.cos(self.angle), math.sin(self.angle)
        return np.array([[c, -s], [s, c]])

    def inverse(self) -> Self:
        """Return the inverse transformation; the frame must not be mirrored."""
        x, y = type(self)(angle=-self.angle).turned(self.point)
        return type(self)((-x, -y), angle=-self.angle)

    def then(self, inner: PlanarFrame) -> Self:
        """Return the frame of a nested part."""
        return type(self)(self.to_outside(inner.point), self.nested_signs(inner), self.oriented(inner.angle))

    def oriented(self, angle: float) -> float:
        """Transform an angle in the part to the outer axes."""
        return self.angle + self.handedness * angle

    def turned(self, v: tuple[float, ...]) -> tuple[float, ...]:
        c, s = (math.cos(self.angle), math.sin(self.angle)) if self.angle else (1.0, 0.0)
        x, y = self.signs[0] * v[0], self.signs[1] * v[1]
        return c * x - s * y, s * x + c * y

    def placed(self, marker: Any) -> Any:
        return marker.model_copy(update={"point": self.to_outside(marker.point), "angle": self.oriented(marker.angle)})

    def half_turned(self, marker: Any, axis: str) -> Any:
        """Return a marker with an axis reversed."""
        return marker.model_copy(update={"angle": marker.angle + math.pi})

    def placed_inertia(self, body: Body) -> dict[str, object]:
        return {"angle": self.oriented(body.angle), "omega": self.handedness * body.omega}

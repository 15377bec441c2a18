"""Placement of a part: entries of ``use``, and frames with mirroring."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from pydantic import Field

from ...reading.fields import Described

if TYPE_CHECKING:
    from ...elements.body import AnyBody

STRAIGHT = 1e-6
"""Largest off-diagonal entry of the mirror in ground axes that is parallel to them, for angles written with six digits."""


class Use(Described):
    """Part placed in a scene or in another part."""

    part: str = Field(description="which of the parts")
    on: str | None = Field(
        None, description="the body that it is mounted on; ground unless given, and within a part that part's mount"
    )
    parameters: dict[str, Any] = Field(
        default_factory=dict, description="values of the part's parameters, by formulas of the parameters around it"
    )
    mounts: dict[str, str] = Field(
        default_factory=dict, description="further bodies that the part connects to, by their names in the part"
    )


@dataclass(frozen=True)
class Frame:
    """Transformation of a point x of a part to p + A S x: S changes signs of coordinates, A rotates.

    Each frame X within a mirrored part, of a body or a marker, becomes S X S and remains right-handed. Along all of
    these axes the k-th component of a force changes its sign by S_kk, and that of a torque or rotation by det S S_kk.
    """

    point: tuple[float, ...]  # p, m
    signs: tuple[float, ...]  # diagonal of S

    @property
    def handedness(self) -> float:
        """Determinant of S: 1, or -1 for a mirror image."""
        return math.prod(self.signs)

    @property
    @abstractmethod
    def rotation(self) -> np.ndarray:
        """Rotation matrix A."""

    @abstractmethod
    def turned(self, v: tuple[float, ...]) -> tuple[float, ...]:
        """Transform a vector of the part to the outer axes."""

    @abstractmethod
    def placed(self, marker: object) -> Any:
        """Return a marker, a placement or a shape in the outer axes."""

    @abstractmethod
    def placed_inertia(self, body: Any) -> Mapping[str, object]:
        """Return the orientation, angular velocity and inertia of a body of the part."""

    def mirror(self) -> Self:
        """Return the mirror alone, which applies to points and axes in the axes of a mirrored body."""
        return type(self)(signs=self.signs)  # type: ignore[call-arg]

    def nested_signs(self, inner: Frame) -> tuple[float, ...]:
        """Return the signs of the frame of a nested part."""
        return tuple(a * b for a, b in zip(self.signs, inner.signs, strict=True))

    def to_outside(self, x: tuple[float, ...]) -> tuple[float, ...]:
        """Transform a point of the part to the outer axes."""
        return tuple(p + d for p, d in zip(self.point, self.turned(x), strict=True))

    def placed_body(self, body: AnyBody) -> AnyBody:
        """Return a body of the part in ground axes."""
        own = self.mirror()
        changed = {
            "position": self.to_outside(body.position),
            "velocity": self.turned(body.velocity),
            "markers": {name: own.placed(marker) for name, marker in body.markers.items()},
            "geometry": tuple(shape.placed(own) for shape in body.geometry),
        }
        return body.model_copy(update={**changed, **self.placed_inertia(body)})

    def ground_signs(self) -> tuple[float, ...] | None:
        """Return the signs of components along ground axes; None if the mirror is oblique to them."""
        whole = self.rotation @ np.diag(self.signs) @ self.rotation.T
        straight = np.max(np.abs(whole - np.diag(np.diag(whole)))) < STRAIGHT
        return tuple(float(np.sign(part)) for part in np.diag(whole)) if straight else None

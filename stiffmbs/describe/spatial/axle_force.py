"""Base of torques about a wheel's axle."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ..element import Force, Symbolic
from .marker import Marker


class AxleForce(Force):
    """Base of torques on i's body about i's y axis, and the opposite on j's body; scenes use its subclasses."""

    i: Marker = Field(description="marker on the wheel, its y axis along the axle, to the left of the heading")
    j: Marker = Field(
        description="the body that takes the opposite torque: the upright outboard, the car's body inboard"
    )

    def spins_with(self) -> dict[str, str]:
        return {"i": "y", "j": "body"}

    @staticmethod
    def spin(e: Symbolic) -> Any:
        """Return the angular velocity of the wheel relative to j's body about its axle, rad/s; positive forward."""
        return e.named((e.i.omega - e.j.omega).dot(e.i.y))

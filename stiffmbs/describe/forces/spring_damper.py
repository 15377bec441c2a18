"""Spring-damper between two points."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import Field

from .. import si
from ..element import Force, Symbolic
from ..marker import Marker


class SpringDamper(Force):
    """Line spring and damper: tension k (L - L0) + c L' + preload, along the line between two points.

    A damping below zero is allowed (it feeds energy in); the points must not coincide while the spring has a
    free length.
    """

    kind: ClassVar[str] = "spring_damper"

    type: Literal["spring_damper"] = "spring_damper"
    i: Marker = Field(description="marker of the first body, on which the force is reported")
    j: Marker = Field(description="marker of the second body")
    stiffness: si.Stiffness = Field(0.0, description="k, N/m")
    damping: si.Damping = Field(0.0, description="c, N s/m")
    free_length: si.LengthOrZero = Field(0.0, description="L0, the length without tension of the spring, m")
    preload: si.Force = Field(0.0, description="tension added at every length, N")

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        length = e.distance(e.i.point, e.j.point)
        tension = e.stiffness * (length - e.free_length) + e.damping * e.rate(length) + e.preload
        return [(-tension, length)]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        length = e.distance(e.i.point, e.j.point)
        return e.stiffness * (length - e.free_length) ** 2 / 2 + e.preload * length

"""Spin angle of a body whose quaternion excludes the spin."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from ..element import Symbolic
from ..marker import MarkerReference
from ..states.equation import StateEquation


class SpinAngle(StateEquation):
    """Angle, rad, of a body's spin about a principal axis, which its quaternion excludes; created by the presolve."""

    kind: ClassVar[str] = ""

    i: MarkerReference
    axis: Literal["x", "y", "z"]

    @staticmethod
    def rate(e: Symbolic) -> Any:
        return e.i.body.u[3 + "xyz".index(e.axis)]

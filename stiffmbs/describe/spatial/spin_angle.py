"""The angle of a body's spin, where its quaternion doesn't follow that."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from ..element import Symbolic
from ..marker import MarkerReference
from ..states.equation import StateEquation


class SpinAngle(StateEquation):
    """The angle, rad, that a body is turned by about a principal axis besides what its quaternion tells; made by the presolve."""

    kind: ClassVar[str] = ""

    i: MarkerReference
    axis: Literal["x", "y", "z"]

    @staticmethod
    def rate(e: Symbolic) -> Any:
        return e.i.body.u[3 + "xyz".index(e.axis)]

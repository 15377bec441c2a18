"""Spring-damper between two points."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import Field

from .. import si
from ..element import Symbolic
from ..formula_field import OfDeflection, OfRate
from ..marker import Marker
from .spring import Spring


class SpringDamper(Spring):
    """Line spring and damper, linear or by curves, along the line between two points.

    With the deflection s = L - L0 and its rate v = L' the tension is
    k s + spring_law(s) + c v + damper_law(v) + preload; tension pulls the points together.

    A damping below zero is allowed (it feeds energy in); the points must not coincide while the spring has a
    free length.  A spring law that is a table or a polynomial in s has a potential; with any other formula the
    element counts none, and energy.total is not kept.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.2 (TSDA).
    """

    kind: ClassVar[str] = "spring_damper"

    type: Literal["spring_damper"] = "spring_damper"
    i: Marker = Field(description="marker of the first body, on which the force is reported")
    j: Marker = Field(description="marker of the second body")
    stiffness: si.Stiffness = Field(0.0, description="k, N/m")
    damping: si.Damping = Field(0.0, description="c, N s/m")
    free_length: si.LengthOrZero = Field(0.0, description="L0, the length without tension of the spring, m")
    preload: si.Force = Field(0.0, description="tension added at every length, N")
    spring_law: OfDeflection | None = Field(None, description="tension added over s = L - L0 (m), N")
    damper_law: OfRate | None = Field(None, description="tension added over v = L' (m/s), N")

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        length = e.distance(e.i.point, e.j.point)
        return [(-Spring.pull(e, length - e.free_length, e.rate(length)), length)]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        length = e.distance(e.i.point, e.j.point)
        return Spring.stored(e, length - e.free_length, length)

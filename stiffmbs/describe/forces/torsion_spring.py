"""Torsion spring-damper."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import Field

from .. import si
from ..element import Symbolic
from ..formula_field import OfDeflection, OfRate
from ..marker import Marker
from .spring import Spring


class TorsionSpring(Spring):
    """Rotational spring and damper, linear or by curves, on the angle of marker i against marker j.

    With the deflection s = angle - free_angle and its rate v the moment
    k s + spring_law(s) + c v + damper_law(v) + preload turns i back towards j, and j as much the other way.

    Angles are counted over whole turns.  A spring law that is a table or a polynomial in s has a potential; with
    any other formula the element counts none, and energy.total is not kept.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.2 (RSDA).
    """

    kind: ClassVar[str] = "torsion_spring"

    type: Literal["torsion_spring"] = "torsion_spring"
    i: Marker = Field(description="marker of the first body, on which the torque is reported")
    j: Marker = Field(description="marker of the second body")
    stiffness: si.TorsionalStiffness = Field(0.0, description="k, N m/rad")
    damping: si.TorsionalDamping = Field(0.0, description="c, N m s/rad")
    free_angle: si.Angle = Field(0.0, description="angle of i against j without moment of the spring, rad")
    preload: si.Torque = Field(0.0, description="moment added at every angle, N m")
    spring_law: OfDeflection | None = Field(None, description="moment added over s = angle - free_angle (rad), N m")
    damper_law: OfRate | None = Field(None, description="moment added over v = angle' (rad/s), N m")

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        angle = e.i.angle - e.j.angle
        return [(-Spring.pull(e, angle - e.free_angle, e.rate(angle)), angle)]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        angle = e.i.angle - e.j.angle
        return Spring.stored(e, angle - e.free_angle, angle)

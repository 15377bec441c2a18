"""Torsion spring-damper, with fields and law common to the plane and space."""

from __future__ import annotations

from typing import Generic

from pydantic import Field

from ...reading.formula.field import TorqueOfDeflection, TorqueOfRate
from ...reading.marker import M, Marker
from ...reading.units import si
from ..element import Expr, Symbolic
from .spring_damper import Spring


class AngleSpring(Spring, Generic[M]):
    """Base of the planar and the spatial torsion spring."""

    kind = "torsion_spring"
    reflected = {
        "free_angle": "angle",
        "preload": "angle",
        "spring_law": "angle",
        "damper_law": "angle",
    }
    forms = ({"stiffness": ..., "damping": ...},)

    i: M = Field(description="marker of the first body, on which the torque is reported")
    j: M = Field(description="marker of the second body")
    stiffness: si.TorsionalStiffness = Field(0.0, description="k, N m/rad")
    damping: si.TorsionalDamping = Field(0.0, description="c, N m s/rad")
    free_angle: si.Angle = Field(0.0, description="angle of i relative to j without moment of the spring, rad")
    preload: si.Torque = Field(0.0, description="constant part of the moment, N m")
    spring_law: TorqueOfDeflection | None = Field(
        None, description="moment added over s = angle - free_angle (rad), N m"
    )
    damper_law: TorqueOfRate | None = Field(None, description="moment added over v = angle' (rad/s), N m")

    @staticmethod
    def angle(e: Symbolic) -> Expr:
        """Return the angle of marker i relative to marker j, with full revolutions."""
        raise NotImplementedError

    @classmethod
    def efforts(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        angle = cls.angle(e)
        return [(-Spring.pull(e, angle - e.free_angle, e.rate(angle)), angle)]

    @classmethod
    def potential(cls, e: Symbolic) -> Expr:
        angle = cls.angle(e)
        return Spring.stored(e, angle - e.free_angle, angle)


class TorsionSpring(AngleSpring[Marker]):
    """Rotational spring and damper on the angle of marker i relative to marker j, linear or nonlinear.

    With the deflection s = angle - free_angle and its rate v the restoring moment on i is k s + spring_law(s) + c v +
    damper_law(v) + preload. The opposite moment acts on j.

    Full revolutions of the angle are counted. A spring law that is a table or a polynomial in s has a potential. With
    any other formula the element has none, and energy.total is not conserved.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.2 (RSDA).
    """

    @staticmethod
    def angle(e: Symbolic) -> Expr:
        return e.i.angle - e.j.angle

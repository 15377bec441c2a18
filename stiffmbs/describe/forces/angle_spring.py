"""What torsion springs share in the plane and in space: their fields, and their law on an angle."""

from __future__ import annotations

from typing import Any, Generic, Literal, TypeVar

from pydantic import Field

from ..element import Symbolic
from ..formula.field import TorqueOfDeflection, TorqueOfRate
from ..marker import MarkerReference
from ..units import si
from .spring import Spring

M = TypeVar("M", bound=MarkerReference)


class AngleSpring(Spring, Generic[M]):
    """Base of the torsion springs of the plane and of space (it has no kind: scenes name its subclasses)."""

    type: Literal["torsion_spring"] = "torsion_spring"
    i: M = Field(description="marker of the first body, on which the torque is reported")
    j: M = Field(description="marker of the second body")
    stiffness: si.TorsionalStiffness = Field(0.0, description="k, N m/rad")
    damping: si.TorsionalDamping = Field(0.0, description="c, N m s/rad")
    free_angle: si.Angle = Field(0.0, description="angle of i against j without moment of the spring, rad")
    preload: si.Torque = Field(0.0, description="moment added at every angle, N m")
    spring_law: TorqueOfDeflection | None = Field(
        None, description="moment added over s = angle - free_angle (rad), N m"
    )
    damper_law: TorqueOfRate | None = Field(None, description="moment added over v = angle' (rad/s), N m")

    @staticmethod
    def angle(e: Symbolic) -> Any:
        """Of marker i against marker j, whole turns counted."""
        raise NotImplementedError

    @classmethod
    def efforts(cls, e: Symbolic) -> list[tuple[Any, Any]]:
        angle = cls.angle(e)
        return [(-Spring.pull(e, angle - e.free_angle, e.rate(angle)), angle)]

    @classmethod
    def potential(cls, e: Symbolic) -> Any:
        angle = cls.angle(e)
        return Spring.stored(e, angle - e.free_angle, angle)

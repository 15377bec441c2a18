"""A brake that holds a wheel at a standstill."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field

from ...element import Symbolic
from ...fields import Measured
from ...formula.field import TorqueOfMotion
from ...roads.road import above_zero, magnitude
from ...units import si
from ..axle_force import AxleForce
from ..wrench import Pairs


class Brake(AxleForce):
    """A brake between a wheel and its upright, or the car's body, that slides at its torque and holds at a standstill.

    The torque on the wheel is -C (z + T z'), with the largest torque C, which may be a formula and is never taken below zero.  The part z of
    it follows the spin w by z' = (w - abs(w) z)/(a + abs(w) L): Dahl's friction, which at rest is a spring of stiffness C/a, and does not
    creep.  Sliding, z is 1 or -1.  The damping by T fades as 1/(1 + (T w/a)^2), so that the torque never exceeds C.  The lag L keeps
    the brake of a fast wheel from being stiff.

    Dahl, Solid friction damping of mechanical vibrations, AIAA Journal 14 (1976) 1675-1682.
    """

    kind: ClassVar[str] = "brake"
    may_keep_energy: ClassVar[bool] = False
    reflected: ClassVar[dict[str, str] | None] = {}
    channels: ClassVar[tuple[str, ...]] = ("braking",)

    torque: TorqueOfMotion = Field(description="C, the largest torque, N m: a number or a formula")
    windup: Annotated[float, Measured("angle", above=0)] = Field(
        0.01, description="a, the angle over which it builds up from a standstill, rad"
    )
    settling: si.PositiveTime = Field(0.005, description="T, of the damping at a standstill, s")
    lag: si.PositiveTime = Field(0.01, description="L, with which it turns round at speed, s")

    def own_states(self) -> tuple[str, ...]:
        return ("part",)

    @classmethod
    def _of_spin(cls, e: Symbolic) -> tuple[Any, Any]:
        """The rate of z, and the braking torque."""
        (z,), w = e.own, cls.spin(e)
        speed = magnitude(w)
        rate = e.named((w - speed * z) / (e.windup + speed * e.lag))
        damping = e.named(e.settling / (1 + (e.settling * w / e.windup) ** 2))
        return rate, e.named(above_zero(e.named(e.torque)) * (z + damping * rate))

    @classmethod
    def rates(cls, e: Symbolic) -> Any:
        return [cls._of_spin(e)[0]]

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        return [(-cls._of_spin(e)[1], cls.spin(e))]

    @classmethod
    def measured(cls, e: Symbolic) -> Any:
        """The torque that slows the wheel."""
        return [cls._of_spin(e)[1]]

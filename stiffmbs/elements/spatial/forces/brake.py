"""Brake that holds a wheel at rest."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ....reading.fields import Measured
from ....reading.formula.field import TorqueOfMotion
from ....reading.units import si
from ...element import Expr, Symbolic
from ...roads.road import above_zero, magnitude
from ..wrench import Pairs
from .wheel_torque import AxleForce


class Brake(AxleForce):
    """Brake between a wheel and its upright, or the car's body, which slips at its torque and holds at rest.

    The torque on the wheel is -C (z + T z'), with the largest torque C, a number or a formula, limited to zero from
    below. The state z follows the spin w by Dahl's friction, z' = (w - abs(w) z)/(a + abs(w) L). At rest this is a
    spring of stiffness C/a that does not slip; when slipping, z is 1 or -1. The damping by T decreases as 1/(1 + (T w/a)^2),
    so the torque never exceeds C. The lag L avoids stiffness at high speed.

    Dahl, Solid friction damping of mechanical vibrations, AIAA Journal 14 (1976) 1675-1682.
    """

    kind = "brake"
    may_keep_energy = False
    reflected = {}
    channels = ("braking",)

    torque: TorqueOfMotion = Field(description="C, the largest torque, N m: a number or a formula")
    windup: Annotated[float, Measured("angle", above=0)] = Field(
        0.01, description="a, the angle over which it builds up from standstill, rad"
    )
    settling: si.PositiveTime = Field(0.005, description="T, time constant of the damping at standstill, s")
    lag: si.PositiveTime = Field(0.01, description="L, time constant of its reversal at speed, s")

    def own_states(self) -> tuple[str, ...]:
        return ("part",)

    @classmethod
    def _of_spin(cls, e: Symbolic) -> tuple[Expr, Expr]:
        """Return the rate of z, and the braking torque."""
        (z,), w = e.own, cls.spin(e)
        speed = magnitude(w)
        rate = e.named((w - speed * z) / (e.windup + speed * e.lag))
        damping = e.named(e.settling / (1 + (e.settling * w / e.windup) ** 2))
        return rate, e.named(above_zero(e.named(e.torque)) * (z + damping * rate))

    @classmethod
    def rates(cls, e: Symbolic) -> list[Expr]:
        return [cls._of_spin(e)[0]]

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        return [(-cls._of_spin(e)[1], cls.spin(e))]

    @classmethod
    def measured(cls, e: Symbolic) -> list[Expr]:
        return [cls._of_spin(e)[1]]

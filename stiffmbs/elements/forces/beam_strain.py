"""Law of a beam element of constant strain, the same in the plane and in space."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from pydantic import Field

from ...reading.units import si
from ..element import Force, Symbolic
from .bushing import times

BEYOND = "found its ends turned by three quarters of a turn against each other, expected less; divide the beam into more elements"
DOUBT = "turns its ends by more than half a turn against each other; divide the beam into more elements"


class BeamStrain(Force):
    """Base of beam elements; scenes use its subclasses `exact_beam`."""

    symbol: ClassVar[str] = "beam"
    beyond: ClassVar[str] = BEYOND
    doubtful: ClassVar[float] = math.sqrt(0.5)
    doubt: ClassVar[str] = DOUBT

    length: si.PositiveLength = Field(description="L, without load, m")
    damping_ratio: si.TimeOrZero | None = Field(None, description="viscous over elastic stiffness, s")

    @staticmethod
    def strain(e: Symbolic) -> list[Any]:
        """Return the strain less that without load."""
        screw = e.logarithm(e.i, e.j).vector
        return e.named([x / e.length - rest for x, rest in zip(screw, e.unloaded, strict=True)])  # type: ignore[no-any-return]

    @classmethod
    def stress(cls, e: Symbolic) -> list[Any]:
        """Return the section forces and moments, N and N m."""
        elastic = times(e.stiffness, cls.strain(e))
        if e.damping_ratio is None:
            return e.named(elastic)  # type: ignore[no-any-return]
        viscous = times(e.stiffness, e.named([rate / e.length for rate in e.logarithm(e.i, e.j).rates]))
        return e.named([f + e.damping_ratio * g for f, g in zip(elastic, viscous, strict=True)])  # type: ignore[no-any-return]

    @classmethod
    def condensed_powers(cls, e: Symbolic) -> list[tuple[Any, Any]]:
        """Return the section forces and moments on the rates of the screw, of which they are linear functions."""
        return [(-f, rate) for f, rate in zip(cls.stress(e), e.logarithm(e.i, e.j).rates, strict=True)]

    @classmethod
    def relative_powers(cls, e: Symbolic) -> list[tuple[Any, Any]]:
        """Return the components of force and torque on i along j's axes, on those of the relative velocities."""
        found = e.logarithm(e.i, e.j)
        efforts = e.named([-x for x in found.conjugate(cls.stress(e))])
        return list(zip(efforts, [*found.velocity, *found.omega], strict=True))

    @classmethod
    def potential(cls, e: Symbolic) -> Any:
        """Return L/2 (Gamma, kappa) K (Gamma, kappa), J."""
        strain = cls.strain(e)
        return e.length * sum(f * x for f, x in zip(times(e.stiffness, strain), strain, strict=True)) / 2

    @classmethod
    def measured(cls, e: Symbolic) -> Any:
        return cls.stress(e)

    @classmethod
    def limits(cls, e: Symbolic) -> Any:
        return [e.logarithm(e.i, e.j).margin]

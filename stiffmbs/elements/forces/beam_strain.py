"""Law of a beam element of constant strain, the same in the plane and in space."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, NamedTuple

from pydantic import AfterValidator, Field, field_validator

from ...reading.units import si
from ..element import Expr, Force, Symbolic
from ..turns import WithinHalfATurn
from .elastic_matrix import times

BEYOND = "found its ends rotated by three quarters of a revolution relative to each other, expected less; divide the beam into more elements"
DampingRatio = Annotated[si.TimeOrZero | None, AfterValidator(lambda found: found or None)]
"""Damping ratio; None for zero, for which nothing is computed."""
DOUBT = "rotates its ends by more than half a revolution relative to each other; divide the beam into more elements"


class Stretch(NamedTuple):
    """Term b/2 x^2 of a component of the strain. `slopes`: derivatives of the strain x by components."""

    to: int
    b: Expr
    x: Expr
    slopes: dict[int, Expr]


class BeamStrain(WithinHalfATurn, Force):
    """Base of beam elements; scenes use its subclasses `exact_beam`."""

    symbol: ClassVar[str] = "beam"
    beyond: ClassVar[str] = BEYOND
    doubtful: ClassVar[float] = math.sqrt(0.5)
    doubt: ClassVar[str] = DOUBT

    length: si.PositiveLength = Field(description="L, without load, m")
    damping_ratio: DampingRatio = Field(None, description="viscous over elastic stiffness, s")
    bowing: tuple[si.NumberOrZero, ...] | None = Field(
        None, description="b for each shear, so that the axis is stretched by b/2 shear^2: 6/5 for a slender element"
    )

    @field_validator("bowing")
    @classmethod
    def _one_for_each_shear(cls, found: tuple[float, ...] | None) -> tuple[float, ...] | None:
        shears = len(cls.channels) // 3
        if found is not None and len(found) != shears:
            raise ValueError(f"found {len(found)} numbers, expected {shears}, one for each shear")
        return found if found and any(found) else None

    @staticmethod
    def strain(e: Symbolic) -> list[Expr]:
        """Return the strain less that without load."""
        screw = e.logarithm(e.i, e.j).vector
        return e.named([x / e.length - rest for x, rest in zip(screw, e.unloaded, strict=True)])  # type: ignore[no-any-return]

    @staticmethod
    def stretching(e: Symbolic, strain: list[Expr]) -> list[Stretch]:
        """Return the terms of second order that are added to the strain."""
        return [Stretch(0, b, strain[k], {k: 1}) for k, b in enumerate(e.bowing or (), 1)]

    @classmethod
    def stress(cls, e: Symbolic) -> list[Expr]:
        """Return the section forces and moments, N and N m."""
        strain = cls.strain(e)
        elastic = times(e.stiffness, cls.bowed(e, strain))
        if terms := cls.stretching(e, strain):
            linear = e.named(list(elastic))
            for to, b, x, slopes in terms:
                for k, slope in slopes.items():
                    elastic[k] += b * linear[to] * x * slope
        if e.damping_ratio is None:
            return e.named(elastic)  # type: ignore[no-any-return]
        viscous = times(e.stiffness, e.named([rate / e.length for rate in e.logarithm(e.i, e.j).rates]))
        return e.named([f + e.damping_ratio * g for f, g in zip(elastic, viscous, strict=True)])  # type: ignore[no-any-return]

    @classmethod
    def bowed(cls, e: Symbolic, strain: list[Expr]) -> list[Expr]:
        """Return the strain with the stretch of an axis that is bent to an S between the nodes, as the shear shows."""
        found = list(strain)
        for to, b, x, _ in cls.stretching(e, strain):
            found[to] += b * x**2 / 2
        return e.named(found)  # type: ignore[no-any-return]

    @classmethod
    def condensed_powers(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return the section forces and moments on the rates of the screw, of which they are linear functions."""
        return [(-f, rate) for f, rate in zip(cls.stress(e), e.logarithm(e.i, e.j).rates, strict=True)]

    @classmethod
    def relative_powers(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return the components of force and torque on i along j's axes, on those of the relative velocities."""
        found = e.logarithm(e.i, e.j)
        efforts = e.named([-x for x in found.conjugate(cls.stress(e))])
        return list(zip(efforts, [*found.velocity, *found.omega], strict=True))

    @classmethod
    def potential(cls, e: Symbolic) -> Expr:
        """Return L/2 (Gamma, kappa) K (Gamma, kappa) with bowing, J."""
        strain = cls.bowed(e, cls.strain(e))
        return e.length * sum(f * x for f, x in zip(times(e.stiffness, strain), strain, strict=True)) / 2

    @classmethod
    def measured(cls, e: Symbolic) -> list[Expr]:
        return cls.stress(e)

    @classmethod
    def limits(cls, e: Symbolic) -> list[Expr]:
        return [e.logarithm(e.i, e.j).margin]

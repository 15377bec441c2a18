"""Level roads with an obstacle: step, cosine bump, sine sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import Field

from ...reading.units import si
from ..element import Expr, Symbolic
from .road import Road, functions_of, ramp


class Obstacle(Road):
    """Base of the level roads with an obstacle; scenes use its subclasses."""

    start: si.Length = Field(description="x at the start of the obstacle, m")
    if TYPE_CHECKING:
        length: float

    def extent(self) -> tuple[float, float]:
        return self.start, self.start + self.length


class StepRoad(Obstacle):
    """Level road with a rise or fall by a cubic with zero slope at both ends: a kerb, a pothole's edge."""

    kind = "step"

    length: si.PositiveLength = Field(description="length over which it rises, m")
    rise: si.Length = Field(description="height after the step, m; negative for a descent")

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        s = ramp(x, r.start, r.length)
        return r.rise * s**2 * (3 - 2 * s)


class CosineBump(Obstacle):
    """Level road with one bump: crest (1 - cos(2 pi (x - start)/length))/2."""

    kind = "cosine_bump"

    length: si.PositiveLength = Field(description="length of the bump, m")
    crest: si.Length = Field(description="height in the middle, m; negative for a hole")

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        of = functions_of(x)
        return r.crest * (1 - of.cos(2 * of.pi * ramp(x, r.start, r.length))) / 2


class SineSweep(Obstacle):
    """Level road with sine waves of varying wavelength.

    With s = (x - start)/length between 0 and 1 the height is amplitude sin(2 pi length (n0 s + (n1 - n0) s^2/2)). The
    wavenumbers are n0 = 1/first_wavelength at the start and n1 = 1/last_wavelength at the end. After it the height is
    constant.
    """

    kind = "sine_sweep"

    length: si.PositiveLength = Field(description="length of the waves, m")
    amplitude: si.Length = Field(description="amplitude of the waves, m")
    first_wavelength: si.PositiveLength = Field(description="wavelength at the start, m")
    last_wavelength: si.PositiveLength = Field(
        description="wavelength at the end, m; equal to the first for a sine wave"
    )

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        of, s = functions_of(x), ramp(x, r.start, r.length)
        first, last = 1 / r.first_wavelength, 1 / r.last_wavelength
        return r.amplitude * of.sin(2 * of.pi * r.length * (first * s + (last - first) * s**2 / 2))

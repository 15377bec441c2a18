"""Sine sweep in a road."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from ..element import Symbolic
from ..units import si
from .road import Road, ramp, ramp_at

if TYPE_CHECKING:
    import numpy as np


class SineSweep(Road):
    """Level road with sine waves of varying wavelength.

    With s = (x - start)/length between 0 and 1 the height is amplitude sin(2 pi length (n0 s + (n1 - n0) s^2/2)). The
    wavenumbers are n0 = 1/first_wavelength at the start and n1 = 1/last_wavelength at the end. After it the height is
    constant.
    """

    kind: ClassVar[str] = "sine_sweep"

    start: si.Length = Field(description="x where it begins, m")
    length: si.PositiveLength = Field(description="over which the waves go on, m")
    amplitude: si.Length = Field(description="of the waves, m")
    first_wavelength: si.PositiveLength = Field(description="at the start, m")
    last_wavelength: si.PositiveLength = Field(description="at the end, m; the same: a plain sine wave")

    @staticmethod
    def height(r: Symbolic, x: Any, y: Any) -> Any:
        """Return the height of the sine sweep."""
        from sympy import Rational, pi, sin

        s = ramp(x, r.start, r.length)
        first, last = 1 / r.first_wavelength, 1 / r.last_wavelength
        return r.amplitude * sin(2 * pi * r.length * (first * s + (last - first) * s**2 * Rational(1, 2)))

    def extent(self) -> tuple[float, float]:
        return self.start, self.start + self.length

    def profile_heights(self, x: np.ndarray) -> np.ndarray:
        """Return the heights, m, of the sweep at positions x, m."""
        from numpy import pi, sin

        s = ramp_at(x, self.start, self.length)
        first, last = 1 / self.first_wavelength, 1 / self.last_wavelength
        return self.amplitude * sin(2 * pi * self.length * (first * s + (last - first) * s**2 / 2))

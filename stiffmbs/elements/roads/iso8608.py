"""Random road after ISO 8608."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final, Literal

import numpy as np
from pydantic import Field, model_validator

from ...reading.table import Table
from ...reading.units import si
from ..element import Expr, Symbolic
from .profile import two_tracks
from .road import Road, ramp
from .rolling_filter import table_of, through_filter

CLASSES = "ABCDEFGH"
SMOOTHEST: Final = 16e-6
"""Gd(n0) of class A, m^3; each further class has four times the value (geometric means of ISO 8608, table C.1)."""
REFERENCE: Final = 0.1
"""Reference wavenumber n0, 1/m."""
POINTS = 4
"""Table points for the shortest wave; the amplitude of a cubic spline is then within 1 %."""


class Iso8608Road(Road):
    """Random road of a class of ISO 8608, reproducible by its seed, with tracks for left and right wheels.

    The displacement power spectral density of each track is Gd(n) = Gd(n0) (n/n0)^-2, n0 = 0.1/m. The class's geometric
    mean is Gd(n0) = 16e-6 m^3 for A, and four times more for each further class. It is a sum of waves of random phase,
    with wavelengths from `longest` down to `shortest`. Each wavelength is `length` divided by an integer, so the road
    repeats after `length`. Left and right are at y = track/2 and -track/2. Between them the height is interpolated by a
    cubic, and beyond them it is constant.

    With ``coherence: isotropic`` both tracks belong to one surface with the same spectrum in all directions. Their
    coherence is (2 pi n track) K1(2 pi n track), near 1 for long waves and near 0 for waves shorter than the track.

    ISO 8608:2016; Robson, Road surface description and vehicle response, Int. J. Vehicle Design 1 (1979) 25-35
    (isotropy).
    """

    kind = "iso8608"

    roughness: Literal["A", "B", "C", "D", "E", "F", "G", "H"] = Field(
        description="roughness class, from A (very good) to H"
    )
    seed: int = Field(0, ge=0, description="seed of the random phases")
    track: si.PositiveLength = Field(1.5, description="distance between the left and the right track, m")
    length: si.PositiveLength = Field(250.0, description="period of the road, m")
    longest: si.PositiveLength = Field(100.0, description="longest wave, m")
    shortest: si.PositiveLength = Field(0.2, description="shortest wave, m")
    coherence: Literal["isotropic", "full", "none"] = Field(
        "isotropic", description="coherence of the left and right tracks"
    )
    start: si.Length | None = Field(None, description="x of the start of the road, m; by default it has no start")
    entry: si.PositiveLength = Field(
        5.0, description="length over which the roughness grows from zero after the start, m"
    )

    @model_validator(mode="after")
    def _waves(self) -> Iso8608Road:
        if not self.shortest < min(self.longest, self.length):
            raise ValueError(
                f"found waves down to {self.shortest:g} m, expected shorter ones than longest and length, {self.longest:g} and "
                f"{self.length:g} m"
            )
        if POINTS * self.length / self.shortest > 1e5:
            raise ValueError(
                f"found waves of {self.shortest:g} m on {self.length:g} m of road, expected at most 25000 times longer"
            )
        return self

    def extent(self) -> tuple[float, float]:
        return 0.0, self.length

    def in_equations(self) -> dict[str, object]:
        """Return the tables of its left and right track, filtered with `filter_radius`."""
        waves = self.track, self.length, self.longest, self.shortest, self.coherence
        tables = _tables(CLASSES.index(self.roughness), self.seed, *waves)
        left, right = (through_filter(table, self.filter_shape) for table in tables)
        own = {name: getattr(self, name) for name in ("friction", "track", "start", "entry")}
        return {**own, "left": left, "right": right}

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        """Return the height of the tracks, blended in after the start."""
        height = two_tracks(r, x, y)
        if r.start is None:
            return height
        s = ramp(x, r.start, r.entry)
        return height * s**2 * (3 - 2 * s)


@lru_cache(maxsize=32)
def _tables(
    roughness: int, seed: int, track: float, length: float, longest: float, shortest: float, coherence: str
) -> tuple[Table, Table]:
    first, last = max(1, math.ceil(length / longest)), math.floor(length / shortest)
    k = np.arange(first, last + 1)
    n = k / length
    density = SMOOTHEST * 4.0**roughness * (n / REFERENCE) ** -2.0
    amplitude = np.sqrt(2 * density / length)
    common, opposite = np.exp(2j * math.pi * np.random.default_rng(seed).random((2, len(k))))
    g = _coherence(coherence, 2 * math.pi * n * track)
    sums, differences = np.sqrt((1 + g) / 2) * common, np.sqrt((1 - g) / 2) * opposite
    left, right = amplitude * (sums + differences), amplitude * (sums - differences)
    return _table(left, k, POINTS * last, length), _table(right, k, POINTS * last, length)


def _coherence(coherence: str, x: np.ndarray) -> np.ndarray:
    """Return the ratio of cross to auto power spectral density of the tracks."""
    if coherence == "isotropic":
        from scipy.special import k1

        return np.asarray(x * k1(x))
    return np.ones_like(x) if coherence == "full" else np.zeros_like(x)


def _table(waves: np.ndarray, k: np.ndarray, count: int, length: float) -> Table:
    """Return the sum of the real parts of waves of k periods each, at equally spaced points."""
    spectrum = np.zeros(count // 2 + 1, dtype=complex)
    spectrum[k] = waves * count / 2
    heights = np.fft.irfft(spectrum, count)
    x = np.linspace(0.0, length, count + 1)
    return table_of(x, np.append(heights, heights[0]), "periodic")

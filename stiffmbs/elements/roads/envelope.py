"""Enveloping contact of a tyre with short obstacles: tandem elliptical cams."""

from __future__ import annotations

from pydantic import Field

from ...reading.units import si
from ..element import Component, Expr, Matrix, Symbolic, sp
from .rolling_filter import Cam

MOST_TRACKS = 20
"""Largest number of tracks."""


class Envelope(Component):
    """Tandem elliptical cams, which roll over the road and give the effective height and slopes of a tyre's contact.

    Each cam is the lower half of a superellipse, abs(x/length)^order + abs(z/height)^order = 1, that moves upright and
    touches the road. A front and a rear cam are `shift` apart along the wheel's heading, on `tracks` parallel lines over
    the `width` across it. The effective height is the mean of all, the effective slopes are those of the plane through
    them. The cams take the place of the road's `filter_radius`.

    Schmeitz, A Semi-Empirical Three-Dimensional Model of the Pneumatic Tyre Rolling over Arbitrarily Uneven Road
    Surfaces, TU Delft (2004), ch. 4; Pacejka, Tire and Vehicle Dynamics (2012), sec. 10.1.6.
    """

    shift: si.PositiveLength = Field(description="distance of the front and rear cams, m: about 0.8 contact lengths")
    length: si.PositiveLength = Field(description="half the length of a cam, m: about the tyre's radius")
    height: si.PositiveLength = Field(description="half the height of a cam, m: about the tyre's radius")
    order: float = Field(1.8, ge=1, le=10, description="exponent of the cam; 2 for an ellipse")
    width: si.LengthOrZero = Field(0.0, description="distance of the outer tracks, m: about the width of the contact")
    tracks: int = Field(2, ge=1, le=MOST_TRACKS, description="number of tracks across the contact, one without a width")

    @property
    def cam(self) -> Cam:
        """Shape of a cam."""
        return Cam(self.length, self.height, self.order)

    def in_equations(self) -> dict[str, object]:
        """Return the distance of the cams, and the positions of the tracks to the left of the wheel's plane."""
        count = self.tracks if self.width else 1
        across = tuple(self.width * (k / (count - 1) - 0.5) for k in range(count)) if count > 1 else (0.0,)
        return {"shift": self.shift, "across": across}


def enveloped(e: Symbolic, x: Expr, y: Expr, axis: Matrix) -> tuple[Expr, Expr, Expr]:
    """Return the effective height of the road, m, and its slopes along x and y, by the cams of a tyre.

    `x`, `y`: place of the wheel's centre in the axes of the road. `axis`: components of the spin axis along them.
    """
    size = e.named(sp.sqrt(axis[0] ** 2 + axis[1] ** 2))
    forward = e.named(axis[1] / size), e.named(-axis[0] / size)
    offsets, half = e.envelope.across, e.envelope.shift * sp.Rational(1, 2)
    squares = sp.Add(*(offset**2 for offset in offsets))
    heights = {}
    for side in (1, -1):
        for offset in offsets:
            along, across = side * half, offset
            place = (
                e.named(x + along * forward[0] - across * forward[1]),
                e.named(y + along * forward[1] + across * forward[0]),
            )
            heights[side, offset] = e.named(e.road.surface(*e.road.place(e, *place)))
    count = len(heights)
    mean = e.named(sp.Add(*heights.values()) / count)
    pitch = e.named(sp.Add(*(side * height for (side, _), height in heights.items())) * 2 / (count * e.envelope.shift))
    moment = sp.Add(*(offset * height for (_, offset), height in heights.items()))
    roll = e.named(moment / (2 * squares) if len(offsets) > 1 else 0)
    return mean, e.named(pitch * forward[0] - roll * forward[1]), e.named(pitch * forward[1] + roll * forward[0])

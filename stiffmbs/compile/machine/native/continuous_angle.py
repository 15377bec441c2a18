"""Angles counted over whole turns, in kernels (`stiffmbs.compile.symbolic.continuous_angle`)."""

from __future__ import annotations

from math import atan2, cos, sin

from .access import compiled


@compiled
def continuous_angle(sine, cosine, counted):
    """The angle with a sine and a cosine that is nearest to what is counted."""
    c, s = cos(counted), sin(counted)
    return counted + atan2(sine * c - cosine * s, cosine * c + sine * s)

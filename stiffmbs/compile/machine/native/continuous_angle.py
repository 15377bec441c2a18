"""Continuous (unwrapped) angles in kernels (`stiffmbs.compile.symbolic.continuous_angle`)."""

from __future__ import annotations

from math import atan2, cos, sin

from .access import compiled


@compiled
def continuous_angle(sine, cosine, counted):
    """Return the angle with a given sine and cosine that is nearest to `counted`."""
    c, s = cos(counted), sin(counted)
    return counted + atan2(sine * c - cosine * s, cosine * c + sine * s)

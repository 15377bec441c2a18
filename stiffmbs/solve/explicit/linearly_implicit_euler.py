"""Linearly implicit Euler scheme and its extrapolation, with fixed steps: stable in stiff scenes, without iterations."""

from __future__ import annotations

from .scheme import Scheme

LINEARLY_IMPLICIT_EULER = Scheme(name="linearly_implicit_euler", order=1, stages=1, c=(0, 1), a=({}, {0: 1}), columns=1)
"""Deuflhard, Recent progress in extrapolation methods for ordinary differential equations, SIAM Review 27 (1985) 505."""
EXTRAPOLATED_EULER = Scheme(name="extrapolated_euler", order=2, stages=1, c=(0, 1), a=({}, {0: 1}), columns=2)
"""Twice the result of two half steps, less that of a whole one: Hairer, Wanner (1996), sec. IV.9."""

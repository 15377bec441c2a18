"""Explicit Runge-Kutta schemes by name."""

from __future__ import annotations

from .dop853 import DOP853
from .dopri5 import DOPRI5
from .linearly_implicit_euler import EXTRAPOLATED_EULER, LINEARLY_IMPLICIT_EULER
from .rk4 import RK4

SCHEMES = {scheme.name: scheme for scheme in (RK4, DOPRI5, DOP853, LINEARLY_IMPLICIT_EULER, EXTRAPOLATED_EULER)}

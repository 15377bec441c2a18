"""Explicit Runge-Kutta schemes, one table of coefficients per file, and their integration loops."""

from .dop853 import DOP853
from .dopri5 import DOPRI5
from .rk4 import RK4

SCHEMES = {scheme.name: scheme for scheme in (RK4, DOPRI5, DOP853)}

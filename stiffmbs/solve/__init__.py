"""Initial values and integrators.  They see a `System`, never a kind of element."""

from . import auto, bdf, kinematic
from .explicit import projected

SOLVERS = {"auto": auto.solve, "bdf": bdf.solve, "projected": projected.solve, "kinematic": kinematic.solve}

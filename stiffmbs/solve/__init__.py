"""Initial values and integrators.  They see a `System`, never a kind of element."""

from . import bdf, kinematic, projected

SOLVERS = {"bdf": bdf.solve, "projected": projected.solve, "kinematic": kinematic.solve}

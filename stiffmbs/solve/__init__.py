"""Initial values and integrators.  They see a `System`, never a kind of element."""

from . import bdf, projected

SOLVERS = {"bdf": bdf.solve, "projected": projected.solve}

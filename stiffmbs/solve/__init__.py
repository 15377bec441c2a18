"""Initial values and integrators. They work on a `System` and know no kinds of element."""

from .implicit_traits import of_auto, of_bdf, of_radau
from .solver import loaded_when_used

SOLVERS = {
    "auto": loaded_when_used(".auto", __name__, of_auto),
    "bdf": loaded_when_used(".bdf", __name__, of_bdf),
    "radau": loaded_when_used(".radau.radau", __name__, of_radau),
    "projected": loaded_when_used(".explicit.projected", __name__),
    "kinematic": loaded_when_used(".kinematic", __name__),
}
"""Solvers by their name in the settings. A new solver needs an entry here and its name in `SolverName` (`stiffmbs.solver_names`)."""

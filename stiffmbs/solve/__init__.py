"""Initial values and integrators.  They see a `System`, never a kind of element."""

from .solver import loaded_when_used

SOLVERS = {
    "auto": loaded_when_used(".auto", __name__),
    "bdf": loaded_when_used(".bdf", __name__),
    "projected": loaded_when_used(".explicit.projected", __name__),
    "kinematic": loaded_when_used(".kinematic", __name__),
}
"""By the name in the settings; a new solver is one entry here, and its name in `RunSettings.solver`."""

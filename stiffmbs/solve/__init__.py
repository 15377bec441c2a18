"""Initial values and integrators.  They see a `System`, never a kind of element."""

from ..describe.settings import RunSettings
from .solver import Traits, loaded_when_used

SOLVERS = {
    "auto": loaded_when_used(".auto", __name__),
    "bdf": loaded_when_used(".bdf", __name__),
    "projected": loaded_when_used(".explicit.projected", __name__),
    "kinematic": loaded_when_used(".kinematic", __name__),
}
"""By the name in the settings; a new solver is one entry here, and its name in `RunSettings.solver`."""


def traits_of(settings: RunSettings) -> Traits:
    """The traits of the solver that the settings choose."""
    return SOLVERS[settings.solver].traits(settings)

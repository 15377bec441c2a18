"""Initial values and integrators.  They see a `System`, never a kind of element."""

from ..describe.settings import RunSettings
from . import auto, bdf, kinematic
from .explicit import projected
from .solver import Registered, Traits

SOLVERS = {
    "auto": Registered(auto.solve, auto.traits),
    "bdf": Registered(bdf.solve, bdf.traits),
    "projected": Registered(projected.solve, projected.traits),
    "kinematic": Registered(kinematic.solve, kinematic.traits),
}
"""By the name in the settings; a new solver is one entry here, and its name in `RunSettings.solver`."""


def traits_of(settings: RunSettings) -> Traits:
    """The traits of the solver that the settings choose."""
    return SOLVERS[settings.solver].traits(settings)

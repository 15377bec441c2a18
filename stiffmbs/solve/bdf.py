"""Variable-order, variable-step BDF by SUNDIALS IDA, as Adams' GSTIFF."""

from __future__ import annotations

from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import InputError
from ..model.settings import RunSettings
from .error_control.error_test import ErrorControl
from .formulations import FORMULATIONS
from .ida.choice import driven
from .ida.native_engine import NativeEngine
from .integrator import Integrator, integrated
from .trajectory import Grid, ProgressCallback, Trajectory


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback,
    control: ErrorControl | None = None,
) -> Trajectory:  # fmt: skip
    """Integrate with IDA; the contract is in `stiffmbs.solve.trajectory`.

    The integrator restarts at breakpoints in time and at events of force laws (a contact closes). Raises InputError
    when the formulation does not test velocities and forces depend on reactions.
    """
    refuse_untested_reactions(dynamics.system, settings)
    dynamics.forget_pivots()
    return integrated(bdf_integrator(dynamics, settings, control), start, grid, watch)


def bdf_integrator(
    dynamics: Dynamics, settings: RunSettings, control: ErrorControl | None = None
) -> Integrator[NativeEngine]:
    """Return the integrator of a system, which may be reused."""
    return Integrator(dynamics, settings, driven(dynamics, settings, control).engine)


def refuse_untested_reactions(system: System, settings: RunSettings) -> None:
    """Refuse forces that depend on reactions in a formulation whose error test excludes velocities.

    A step size change causes velocity errors that violate the constraints, which the next steps remove. Friction turns
    their reactions into velocity errors along the constraints, which remain.
    """
    if "u" in FORMULATIONS[settings.formulation](settings).tested:
        return
    if system.forces_by_reactions:
        raise InputError(
            f"formulation {settings.formulation}: found forces that depend on reactions ({', '.join(system.forces_by_reactions)}), expected "
            "formulation SI2, SI1 or index1: the error test of this one does not include velocities"
        )

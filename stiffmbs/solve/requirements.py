"""What a run will need compiled, known before it starts."""

from __future__ import annotations

from ..compile.routines import Routine
from ..describe.settings import RunSettings
from .explicit import adaptive, fixed
from .formulations import FORMULATIONS
from .mechanics import ROUTINES
from .sundials import connection, ida

ALWAYS = ("position", "motion", "acceleration", "output")


def required(settings: RunSettings) -> tuple[tuple[str, ...], tuple[Routine, ...]]:
    """The term sets and the routines of a run."""
    if settings.solver == "projected":
        steps = {"euler_cromer": fixed.EULER_CROMER, "rk4": fixed.FIXED_STEPS}.get(settings.scheme, adaptive.ADVANCE)
        return ALWAYS, (*ROUTINES, steps)
    if settings.solver == "kinematic":
        return ALWAYS, ROUTINES
    formulation = FORMULATIONS[settings.formulation](settings)
    term_sets = tuple(dict.fromkeys((*ALWAYS, formulation.residual_set, formulation.matrix_set, "tangent")))
    driver = (ida.STEPS if settings.points == "steps" else ida.ADVANCE, connection.RESIDUAL, connection.JACOBIAN)
    return term_sets, (*ROUTINES, *driver)

"""Variable-order, variable-step BDF by SUNDIALS IDA, as Adams' GSTIFF."""

from __future__ import annotations

from collections.abc import Callable

from ..compile.system import System
from ..dynamics.algebraic_states import no_value_ahead
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import InputError, SolverError
from ..model.settings import RunSettings
from .error_control.error_test import ErrorControl
from .error_control.precision import governed_by_rounding, too_fine
from .error_control.relaxation import RELAXATION, refuse_drift
from .events.chattering import CHATTERING
from .events.refusals import DIVERGENCE, refuse_beyond_sense
from .explicit.native.parameters import CONTROL
from .formulations import FORMULATIONS
from .ida.native_engine import Reached
from .integrator import Integrator
from .reasons import Reason
from .step_logging import is_logged, log_step
from .suspect import suspect
from .trajectory import Ending, Grid, ProgressCallback, Rows, Trajectory


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
    return integrated(Integrator(dynamics, settings, control), start, grid, watch)


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


def integrated(
    integrator: Integrator,
    start: InitialValues,
    grid: Grid,
    watch: ProgressCallback,
    pays: Callable[[Reached], bool] | None = None,
) -> Trajectory:
    """Integrate with an integrator that may be reused.

    `pays`: called after each return of the engine. The run ends at `integrator.reached` when it returns False.
    """
    rows = Rows.of(integrator.dynamics.system, grid)
    rows.append(grid.start, start.q, start.u)
    if grid.recorded.most:
        integrator.engine.record_steps(grid.recorded)
    with Ending() as ending:
        for reached in integrator.run(start, grid, passing=not is_logged()):
            # multipliers are in no error test: those of the output times follow from the accelerations at q and u
            rows.extend(reached.times, *integrator.equations.states(reached.rows))
            if is_logged() and (step := integrator.engine.last_step()):
                log_step(reached.t, *step)
            watch(reached.t)
            grid.look(rows)
            integrator.engine.ida.watch.refuse_departures(reached.t)
            integrator.reached = reached
            if failure := _failure(integrator, reached, grid):
                raise SolverError(Reason.NO_STEP.of(f"stopped at t = {reached.t:.9g} s: {failure}"))
            if pays and not pays(reached):
                break
            if reached.t < grid.end and integrator.steps() >= RELAXATION.check_interval:
                state = integrator.split(reached.y)
                refuse_drift(integrator.dynamics, reached.t, *state, integrator.settings)
                if integrator.steps() >= DIVERGENCE.followed_steps:
                    refuse_beyond_sense(integrator.dynamics, rows, reached.t, *state)
    statistics = {**integrator.statistics(), "seconds": ending.seconds}
    history = integrator.engine.history()
    return Trajectory(
        *rows.stored,
        ending.outcome,
        ending.message,
        statistics,
        history,
        integrator.note(),
        whole_steps=integrator.whole_steps(),
        recorded=tuple(filter(None, [integrator.engine.recorded()])),
        departures=integrator.engine.ida.watch.departures(),
    )


def _failure(integrator: Integrator, reached: Reached, grid: Grid) -> str:
    """Return the reason why the run ends at this state, or an empty string."""
    steps = integrator.steps()
    endless = (grid.end - reached.t) * steps > CHATTERING.steps_ahead * (reached.t - grid.start)
    by_rounding = steps > CONTROL.enough_steps and (endless or governed_by_rounding(integrator.statistics()))
    if not (by_rounding or reached.failure):
        return ""
    q, u = integrator.split(reached.y)
    missing = no_value_ahead(integrator.dynamics, reached.t, q, u) if reached.failure else ""
    reason = missing or too_fine(integrator.dynamics, integrator.settings, reached.t, q)
    if reason or not reached.failure:
        return reason
    return reached.failure + suspect(integrator.dynamics, reached.t, q, u)

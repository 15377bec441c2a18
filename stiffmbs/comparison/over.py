"""Run time at an equal error against a parameter of a model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Unpack

from ..analyses.job import Runnable, data_of
from ..analyses.load_scene import with_parameter
from ..compile.machine.routines import fully_compiled
from ..errors import AssemblyError, InputError, SolverError
from ..model.settings import RunSettings, Settings, takes_settings
from ..reading.variation import numbers_of, variation
from .at_error import times_at
from .compare import measured, refuse_unmeasured
from .comparison_over import AtValue, ComparisonOver
from .measures import measure_of
from .plan import LONGER_REFERENCE, LONGEST_RUN, REPEATS, TOLERANCES, USUAL, Entry, Plan, Values, base_settings, plan_of
from .reference import Tell, reference
from .sweep import Sweep

USUAL_ERROR = 1e-4
"""Default error in positions, m or rad."""
Family = Callable[[float], Runnable]


@takes_settings
@fully_compiled()
def compare_over(
    model: str | Path | Family,
    parameter: str,
    values: Values,
    error: float | None = None,
    solvers: Sequence[str] = USUAL,
    formulations: Sequence[str] = (),
    tolerances: Values = TOLERANCES,
    steps: Values | None = None,
    measure: str = "positions",
    repeats: int = REPEATS,
    longest: float = LONGEST_RUN,
    settings: RunSettings | None = None,
    tell: Tell | None = None,
    **changes: Unpack[Settings],
) -> ComparisonOver:
    """Measure run time at an equal error against a parameter of a model, and find where bdf and explicit steps cross.

    Parameters
    ----------
    model : str, Path or callable
        A scene's file, or a function of a value that returns a model, a scene or a file's name.
    parameter : str
        A parameter of the scene, or the path of any of its values; for a function, any name.
    values : sequence of float, Range or str
        Values of the parameter, SI units, or text with units such as ``"1e5:1e9:9:log"``; without a count there is one
        per decade.
    error : float, optional
        Error at which times are compared, in the unit of the measure; by default 1e-4 m or rad for positions.
    solvers, formulations, tolerances, steps, measure, repeats, longest, settings, tell, **changes
        As for `stiffmbs.compare`.

    Returns
    -------
    ComparisonOver

    Raises
    ------
    InputError
        As for `stiffmbs.run`.
    SolverError
        If there is no reference at any value, or no solver reaches the error.
    """
    plan = plan_of(solvers, formulations, tolerances, steps, measure, repeats, longest)
    at_error = _error(error, measure)
    varied = variation(parameter, values)
    made = model if callable(model) else with_parameter(model, parameter, dimension=varied.dimension)
    found: list[AtValue] = []
    entries: tuple[Entry, ...] = ()
    name, interrupted = "", False
    for value in numbers_of(varied, 1):
        data = data_of(made(value))
        base = base_settings(data, settings, changes)
        name, entries = data.name, plan.entries(base)
        report = partial(_report, tell, f"{parameter} = {value:.4g}")
        try:
            exact = reference(data, base, LONGER_REFERENCE * plan.longest, report)
            refuse_unmeasured(plan, exact)
            sweep = Sweep(data, base, exact, plan.longest, report)
            one, interrupted = _at_value(value, sweep, plan, entries, at_error, report)
        except (SolverError, AssemblyError) as refused:
            one = AtValue(value, (), None, str(refused))
        except KeyboardInterrupt:
            if not found:
                raise
            interrupted = True
            break
        found.append(one)
        if interrupted:
            break
    if not any(one.at for one in found):
        raise SolverError(next((one.message for one in found if one.message), "no solver reached the error"))
    return ComparisonOver(name, parameter, measure, at_error, tuple(found), entries, interrupted)


def _at_value(
    value: float, sweep: Sweep, plan: Plan, entries: Sequence[Entry], error: float, tell: Tell
) -> tuple[AtValue, bool]:
    """Return times at the error for one value, and True if the user ended this early."""
    resolved = sweep.reference.resolved(plan.measure)
    if error < resolved:
        message = f"the reference has an accuracy of {resolved:.1e}, expected a larger error"
        return AtValue(value, (), None, message), False
    target = (plan.measure, error)
    swept = (point for entry in entries for point in sweep.points(entry, plan.values(entry, sweep.settings), target))
    points, interrupted = measured(swept, plan, tell)
    rows = tuple(point.row() for point in points)
    at = next(times_at(rows, plan.measure, resolved, [error]), None)
    missing = [entry.name for entry in entries if at is None or entry.name not in at.seconds]
    messages = {row.solver: row.message for row in rows if row.message}  # the last of each solver
    reasons = [f"{name}: {messages.get(name, 'the error was not reached')}" for name in missing]
    return AtValue(value, rows, at, "; ".join(reasons)), interrupted


def _report(tell: Tell | None, where: str, line: str) -> None:
    if tell:
        tell(f"{where}: {line}")


def _error(error: float | None, measure: str) -> float:
    """Return the error at which times are compared; only positions have a default."""
    if error is None and measure != "positions":
        raise InputError(
            f"error: found none, expected one in {measure_of(measure).unit}, as errors of {measure} are compared"
        )
    if error is not None and not error > 0:
        raise InputError(f"error: found {error}, expected more than 0")
    return error or USUAL_ERROR

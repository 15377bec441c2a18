"""Estimate of the errors of all channels of a run from its recorded steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..model.model_data import ModelData
from ..model.settings import DEFAULT_RTOL, RunSettings
from ..notes import Note, NoteKind
from ..results.digits import KnownErrors, largest_bar, over_time
from ..results.error_bars import UNKNOWN, ErrorEstimate, bars
from ..results.solution import Solution
from ..run_checks.lost_digits import rounded_forces
from ..solve.settings import near_constraints, traits_of
from ..solve.subsystems import Subsystem
from ..solve.trajectory import Trajectory
from .along_run import StateErrors, state_errors
from .channels import channel_errors
from .evaluated import evaluated
from .parameters import ESTIMATE
from .singular_poses import refuse_singular

LOST = NoteKind(
    "solution-lost",
    "the solution is lost from t = {t:.3g} s on: its estimated error exceeds {limit:g} rad or as large a part of the "
    "mechanism, and grows",
    "use a smaller rtol",
)
LARGE = NoteKind(
    "large-error",
    "the estimated error of {element} is {error}, {percent:.2g} % of its largest value",
    "use a smaller {setting}",
)


def estimated(
    solution: Solution, model: ModelData, dynamics: Dynamics, start: InitialValues, subsystems: Sequence[Subsystem],
    trajectory: Trajectory, settings: RunSettings,
) -> Solution:  # fmt: skip
    """Return the results of a run with its error bars, from the steps that the trajectory recorded."""
    parts, own = subsystems or (None,), [part.dynamics for part in subsystems] or [dynamics]
    try:
        found = [state_errors(*each, settings.rtol) for each in zip(own, trajectory.recorded, strict=False)]
        lost = [_lost(*each) for each in zip(own, found, strict=False) if each[1].lost.any()]
        if lost:
            return _lost_from(solution, min(lost))
        project, rtol = near_constraints(settings), settings.rtol
        of_channels = [
            channel_errors(model, dynamics, start, part, each, solution.channels, trajectory, project, rtol)
            for part, each in zip(parts, found, strict=False)
        ]
    except (SolverError, np.linalg.LinAlgError) as error:
        sentence = f"not estimated: {error}; --verify compares with other runs"
        return replace(solution, estimate=ErrorEstimate("none", sentence))
    found_bars = bars(solution.time, solution.channels, of_channels, ESTIMATE.numbers_at_once)
    return with_bars(replace(solution, errors=found_bars), settings, dynamics, trajectory)


def with_bars(solution: Solution, settings: RunSettings, dynamics: Dynamics, trajectory: Trajectory) -> Solution:
    """Return a solution with error bars, with the sentence on its errors and a note if they are large."""
    size = dynamics.system.size
    absolute = settings.atol or settings.rtol * min(1.0, size)  # an error of it is not large, as where nothing moves
    estimate = ErrorEstimate("estimated", "", resolved=absolute / ESTIMATE.large)
    known = KnownErrors(replace(solution, estimate=estimate))
    if any(error > ESTIMATE.large for error in known.relative(largest_bar, "forces").values()):
        estimate = _without_rounding(estimate, dynamics, trajectory, float(solution.time[-1]))
        known = KnownErrors(replace(solution, estimate=estimate))
    notes = () if settings.accuracy else tuple(_large_errors(solution, known, settings, size))
    return replace(solution, estimate=known.estimate(), notes=(*solution.notes, *notes))


def _without_rounding(estimate: ErrorEstimate, dynamics: Dynamics, trajectory: Trajectory, t: float) -> ErrorEstimate:
    """Return an estimate that distinguishes forces from rounding, of which they have at most the part of a note.

    `t`: last time of the results, s, at which the rounding of coordinates is taken; the state is changed.
    """
    state, last = dynamics.state, min(int(np.searchsorted(trajectory.t, t)), len(trajectory.t) - 1)
    state.q[:], state.u[:] = trajectory.q[last], trajectory.u[last]
    (force, _), (torque, _) = map(max, rounded_forces(state, t))
    return replace(estimate, resolved_force=force / ESTIMATE.large, resolved_torque=torque / ESTIMATE.large)


def _large_errors(solution: Solution, known: KnownErrors, settings: RunSettings, size: float) -> Iterator[Note]:
    """Yield a note on the largest error, if a position is wrong by many tolerances or any channel by much."""
    rtol, fixed = max(settings.rtol, DEFAULT_RTOL), traits_of(settings).fixed_steps
    absolute = max(settings.atol or 0.0, rtol * min(1.0, size))
    errors, limits = known.relative(over_time), {}
    for name in errors:
        bar = solution.errors[name]
        between = np.nan_to_num(max(bar.sampled_least, bar.sampled_greatest))  # where the largest value may lie
        errors[name] /= 1.0 + between / known.sizes[name]
        tolerance = rtol + absolute / known.sizes[name]
        has_tolerance = known.group[name] == "positions" and not fixed
        limits[name] = min(ESTIMATE.tolerances * tolerance, ESTIMATE.large) if has_tolerance else ESTIMATE.large
    worst = max(limits, key=lambda name: errors[name] / limits[name], default="")
    if worst and errors[worst] > limits[worst]:
        error = f"{solution.errors[worst].over_time:.2g} {solution.unit(worst)}".strip()
        setting = "step" if fixed else "rtol, or accuracy: to choose it by the estimate"
        yield LARGE(worst, error=error, percent=100 * errors[worst], setting=setting)


def _lost(dynamics: Dynamics, found: StateErrors) -> float:
    """Return the time from which errors are too large for a linear estimate, s.

    Raise a SolverError if the motion has passed a singular pose before, where the linear equations do not hold.
    """
    before = slice(0, int(np.argmax(found.lost)) + 1)
    at = evaluated(dynamics, found.t[before], found.recorded_q[before], found.recorded_u[before])
    refuse_singular(dynamics, at.t, at.q, at.u)
    return float(found.t[before.stop - 1])


def _lost_from(solution: Solution, t: float) -> Solution:
    """Return a solution whose errors are lost from a time on."""
    note = LOST(t=t, limit=ESTIMATE.lost)
    return replace(
        solution, estimate=ErrorEstimate("lost", str(note)), notes=(*solution.notes, note),
        errors=dict.fromkeys((name for name in solution.channels if not name.startswith("constraint.")), UNKNOWN),
    )  # fmt: skip

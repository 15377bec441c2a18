"""Estimate of the errors of all channels of a run from its recorded steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from operator import attrgetter

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..model.model_data import ModelData
from ..model.settings import DEFAULT_RTOL, RunSettings
from ..results.digits import digits, digits_words, group_of, largest_bar, relative_bars
from ..results.error_bars import UNKNOWN, ErrorBar
from ..results.estimate import ErrorEstimate
from ..results.solution import Solution
from ..solve.settings import near_constraints
from ..solve.subsystems import Subsystem
from ..solve.trajectory import Trajectory
from .along_run import StateErrors, state_errors
from .channels import bars, channel_errors
from .parameters import ESTIMATE

PEAKS = 2.0
"""Ratio of the error of a peak to the largest at output times from which it is mentioned."""
REMEDY = "use a smaller rtol, or accuracy: to choose it by the estimate"


def estimated(
    solution: Solution, model: ModelData, dynamics: Dynamics, start: InitialValues, subsystems: Sequence[Subsystem],
    trajectory: Trajectory, settings: RunSettings,
) -> Solution:  # fmt: skip
    """Return the results of a run with its error bars, from the steps that the trajectory recorded."""
    parts = subsystems or (None,)
    try:
        found = [
            state_errors(part.dynamics if part else dynamics, pieces)
            for part, pieces in zip(parts, trajectory.recorded, strict=False)
        ]
        lost = [
            t
            for part, each in zip(parts, found, strict=False)
            if (t := _lost(part.dynamics if part else dynamics, each)) is not None
        ]
        if lost:
            return _lost_from(solution, min(lost))
        project, rtol = near_constraints(settings), settings.rtol
        of_channels = [
            channel_errors(model, dynamics, start, part, each, trajectory, project, rtol)
            for part, each in zip(parts, found, strict=False)
        ]
    except (SolverError, np.linalg.LinAlgError) as error:
        sentence = f"not estimated: {error}; --verify compares with other runs"
        return replace(solution, estimate=ErrorEstimate("none", sentence))
    return with_bars(replace(solution, errors=bars(solution.time, solution.channels, of_channels)), settings)


def with_bars(solution: Solution, settings: RunSettings) -> Solution:
    """Return a solution with error bars, with the sentence on its errors and a note if they are large."""
    at_outputs, of_peaks = _largest(solution, attrgetter("over_time")), _largest(solution, largest_bar)
    largest, relative = at_outputs
    sentence = digits_words(digits(solution, peaks=False))
    if largest:
        sentence += f"; largest error: {largest} {100 * relative:.2g} %"
    if of_peaks[1] > PEAKS * relative:
        sentence += f"; peaks between output times: up to {100 * of_peaks[1]:.2g} % ({of_peaks[0]})"
    estimate = ErrorEstimate("estimated", sentence, largest, relative)
    return replace(
        solution,
        estimate=estimate,
        notes=(*solution.notes, *(() if settings.accuracy else _large_errors(solution, settings))),
    )


def _largest(solution: Solution, error_of: Callable[[ErrorBar], float]) -> tuple[str, float]:
    """Return the channel with the largest error relative to its size, and that error."""
    grouped = {name: error_of(bar) for name, bar in solution.errors.items() if group_of(solution, name)}
    known = relative_bars(solution, grouped)
    largest = max(known, key=lambda name: known[name], default="")
    return largest, known.get(largest, float("nan"))


def _large_errors(solution: Solution, settings: RunSettings) -> Iterator[str]:
    """Yield a sentence on the largest error, if a position is wrong by many tolerances or any channel by much."""
    known = relative_bars(solution, {name: bar.over_time for name, bar in solution.errors.items()})
    many = ESTIMATE.tolerances * max(settings.rtol, DEFAULT_RTOL)
    limits = {
        name: min(many, ESTIMATE.large) if group_of(solution, name) == "positions" else ESTIMATE.large
        for name in known if group_of(solution, name)
    }  # fmt: skip
    worst = max(limits, key=lambda name: known[name] / limits[name], default="")
    if worst and known[worst] > limits[worst]:
        unit = solution.unit(worst)
        error = solution.errors[worst].over_time
        yield (
            f"the estimated error of {worst} is {error:.2g} {unit}, {100 * known[worst]:.2g} % of its largest value; {REMEDY}"
        )


def _lost(dynamics: Dynamics, found: StateErrors) -> float | None:
    """Return the time from which errors are too large for a linear estimate, s, or None."""
    system = dynamics.system
    of_poses = np.abs(found.errors[:, : system.n_u])
    scale = system.per_velocity(system.size, 1.0)
    beyond = ~(of_poses <= ESTIMATE.lost * scale).all(axis=1)
    return float(found.t[np.argmax(beyond)]) if beyond.any() else None


def _lost_from(solution: Solution, t: float) -> Solution:
    """Return a solution whose errors are lost from a time on."""
    sentence = (
        f"the solution is lost from t = {t:.3g} s on: its estimated error exceeds {ESTIMATE.lost:g} rad or as large a part "
        "of the mechanism, and grows; use a smaller rtol"
    )
    return replace(
        solution, estimate=ErrorEstimate("lost", sentence), notes=(*solution.notes, sentence),
        errors=dict.fromkeys((name for name in solution.channels if not name.startswith("constraint.")), UNKNOWN),
    )  # fmt: skip

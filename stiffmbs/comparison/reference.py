"""Reference of a comparison: a motion on which an implicit and an explicit integrator agree."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..analyses.job import prepare
from ..analyses.run import solved
from ..errors import SolverError
from ..model.model_data import ModelData
from ..model.settings import RunSettings
from ..reading.files.quoted import listed
from ..results.scales import kind_of, scales
from ..results.solution import Solution
from ..solve.settings import changed, traits_of
from ..solve.trajectory import Outcome
from ..verification.parameters import VERIFICATION
from ..verification.solve_again import BDF, EXPLICIT, Deadline, uninterrupted
from .measures import MEASURES, ROTATION, compared, difference, largest

TIGHT, TIGHTER = 1e-12, VERIFICATION.tightest_rtol
LOOSER = tuple(float(f"1e{k}") for k in range(-11, -8))
"""Relative tolerances: the first, the next if the integrators disagree, the others if a run does not end.

In the stiffest scenes rounding stops steps at tight tolerances.
"""
NEAR_ENOUGH, AGREED = 1e-6, 1e-5
"""Differences relative to a channel's motion: no tighter runs below the first, no reference above the second."""
FORCES_AGREED = 1e-2
"""Accepted difference of a force relative to its size; stiff springs magnify differences of positions."""
NO_MOTION = 1e-4
"""Size of motions below which they need not agree relative to themselves, in sizes of the mechanism and rad."""
RESOLVED = 3.0
"""Ratio of the smallest resolved error to the difference of the two integrators."""
ROUNDING_OF_A_RUN = 1e-11
"""Rounding error over a run, relative to the size of a measure."""

Tell = Callable[[str], None]


@dataclass(frozen=True)
class Reference:
    """Motion on which two integrators agree."""

    solution: Solution  # solution of the explicit one
    names: tuple[str, str]  # names of the runs: ``bdf at rtol 1e-12`` and ``dop853 at rtol 1e-12``
    channels: Mapping[str, tuple[str, ...]]  # channels that each measure compares
    agreement: Mapping[str, float]  # largest difference of the two in each measure
    part: float  # largest difference of positions, relative to the motion of each body
    left_out: tuple[str, ...]  # reactions that are not compared, as rigid bodies do not determine them
    notes: tuple[str, ...]

    def errors(self, channels: Mapping[str, np.ndarray]) -> dict[str, float]:
        """Return the largest error of a motion over time in each measure."""
        return {
            measure: max(largest(channels, self.solution, name) for name in names)
            for measure, names in self.channels.items()
            if names
        }

    def resolved(self, measure: str) -> float:
        """Return the smallest error that exceeds the error of the reference and rounding."""
        return max(RESOLVED * self.agreement[measure], ROUNDING_OF_A_RUN * self.size(measure))

    def size(self, measure: str) -> float:
        """Return the largest value of the channels of a measure; for positions, the largest change since the start."""
        at_start = measure == "positions"
        values = [self.solution[name] for name in self.channels[measure] if name in self.solution.channels]
        return max((float(np.nanmax(np.abs(v - v[0] if at_start else v))) for v in values), default=1.0)

    def sentences(self) -> list[str]:
        """Return sentences on the agreement of the two integrators, and on the channels that are not compared."""
        agree = ", ".join(f"{self.agreement[name]:.1e} {MEASURES[name].unit} ({name})" for name in self.agreement)
        stated = [f"reference: {self.names[0]} and {self.names[1]} agree within {agree}"]
        if self.left_out:
            stated.append(f"not compared, as rigid bodies do not determine them: {listed(self.left_out)}")
        return [*stated, *self.notes]


@dataclass(frozen=True)
class _Pair:
    """Solutions of both integrators at a tolerance."""

    implicit: Solution
    explicit: Solution
    names: tuple[str, str]
    sizes: Mapping[str, float]
    channels: Mapping[str, tuple[str, ...]]

    def parts(self, measure: str) -> dict[str, np.ndarray]:
        """Return the differences over time in the channels of a measure, relative to the size of each."""
        return {
            name: difference(self.implicit, self.explicit, name) / size
            for name in self.channels[measure]
            if (size := 1.0 if name.endswith(ROTATION) else self.sizes[name])
        }

    def part(self, measure: str) -> float:
        """Return the largest difference in a measure, relative to the sizes of the channels."""
        return max((float(np.nanmax(values)) for values in self.parts(measure).values()), default=0.0)


def reference(model: ModelData, settings: RunSettings, allowed: float, tell: Tell) -> Reference:
    """Solve a model at tight tolerances by both integrators.

    `settings`: settings of the comparison that do not depend on the solver. `allowed`: time limit of each run, s.
    `tell`: called with a line of text on the progress. Raises SolverError if a run does not reach the end, or they
    disagree; the message names the channel, the time and the difference; and other errors of `stiffmbs.run`.
    """
    best, unended = None, ""
    for rtol in (TIGHT, TIGHTER, *LOOSER):
        if (rtol == TIGHTER and best is None) or (rtol in LOOSER and best is not None):
            continue
        found = _pair(model, settings, rtol, allowed, tell)
        if isinstance(found, str):
            unended = unended or found
            continue
        if best is None or found.part("positions") < best.part("positions"):
            best = found
        if best.part("positions") <= NEAR_ENOUGH:
            break
    if best is None:
        raise SolverError(unended)
    if not best.part("positions") <= AGREED:
        raise SolverError(_disagreement(best, settings))
    return _agreed(best)


def _pair(model: ModelData, settings: RunSettings, rtol: float, allowed: float, tell: Tell) -> _Pair | str:
    """Return both runs, or the reason why there is no such pair."""
    solutions, names = [], []
    for integrator in (BDF, EXPLICIT):
        chosen = changed(settings, {**integrator, "rtol": rtol, "atol": None})
        names.append(f"{traits_of(chosen).name} at rtol {rtol:g}")
        tell(f"reference: {names[-1]}")
        job = prepare(model, chosen)
        deadline = Deadline(job.grid.start, job.grid.end, allowed)
        found = uninterrupted(solved(job, deadline), deadline)
        if found.outcome is not Outcome.DONE:
            return _unended(names[-1], found, job.grid.end, allowed if deadline.passed else 0.0)
        solutions.append(found)
    explicit = solutions[1]
    return _Pair(
        solutions[0], explicit, (names[0], names[1]), _sizes(explicit, job.dynamics.system.size), compared(explicit)
    )


def _sizes(solution: Solution, size: float) -> dict[str, float]:
    """Return the scales of channels; those of positions and angles are at least `NO_MOTION`."""
    least = {"position": NO_MOTION * size, "angle": NO_MOTION}
    found = scales(solution.channels, size, solution.requested)
    return {name: max(scale, least.get(kind_of(name), 0.0)) for name, scale in found.items()}


def _unended(name: str, found: Solution, end: float, allowed: float) -> str:
    why = found.message
    if allowed:
        why = f"aborted at t = {found.time[-1]:.4g} s of {end:.4g} s: it would take more than {allowed:.4g} s"
    return (
        f"no reference: {name}: {why}; expected an implicit and an explicit integrator that complete the run and agree; "
        "try a shorter duration" + (", or a larger 'longest'" if allowed else "")
    )


def _disagreement(pair: _Pair, settings: RunSettings) -> str:
    parts = pair.parts("positions")
    beyond = {name: np.flatnonzero(~(values <= AGREED)) for name, values in parts.items()}
    name = min((name for name, at in beyond.items() if len(at)), key=lambda name: beyond[name][0])
    times, first = pair.explicit.time, int(beyond[name][0])
    apart = difference(pair.implicit, pair.explicit, name)
    worst = int(np.nanargmax(apart))
    unit = "rad" if name.endswith(ROTATION) else pair.explicit.unit(name)
    until = float(f"{0.9 * (times[first] - settings.start):.1g}")
    remedy = f"compare a shorter duration, such as {until:g} s" if until > 0 else "compare another scene"
    return (
        f"no reference: {pair.names[0]} and {pair.names[1]} disagree: {name} differs by more than {AGREED:g} of its motion "
        f"from t = {times[first]:.4g} s on, by {apart[worst]:.2g} {unit} at t = {times[worst]:.4g} s; the motion is chaotic, "
        f"may branch, or has an event that a step misses; {remedy}"
    )


def _agreed(pair: _Pair) -> Reference:
    channels, notes = dict(pair.channels), []
    apart = {
        name: part
        for name, values in pair.parts("forces").items()
        if (part := float(np.nanmax(values))) > FORCES_AGREED
    }
    if apart:
        worst = max(apart, key=lambda name: apart[name])
        over = difference(pair.implicit, pair.explicit, worst)
        at = int(np.nanargmax(over))
        notes.append(
            f"forces are not compared: the two integrators differ in {worst} by {over[at]:.2g} {pair.explicit.unit(worst)} "
            f"at t = {pair.explicit.time[at]:.4g} s"
        )
        channels["forces"] = ()
    agreement = {
        measure: max(largest(pair.implicit, pair.explicit, name) for name in names)
        for measure, names in channels.items()
        if names
    }
    return Reference(
        pair.explicit, pair.names, channels, agreement, pair.part("positions"), pair.explicit.not_unique, tuple(notes)
    )

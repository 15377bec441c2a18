"""Missed events in steps much longer than their predecessors.

The integrator's polynomial has a rate of the velocities within a step. If it contradicts the accelerations of the block
system at the polynomial's own state, the step has missed the forces there.
"""

from __future__ import annotations

import numpy as np

from ..dynamics.dynamics import OutputRows
from ..model.settings import RunSettings
from ..solve.error_control.tolerances import absolute_tolerances
from ..solve.events.long_steps import LONG_STEP, LongSteps, Motion
from ..solve.settings import near_constraints
from .overlooked import Overlooked, acting
from .parameters import RUN_CHECKS


def overlooked_in_long_steps(found: LongSteps, settings: RunSettings, end: float) -> Overlooked | None:
    """Return the events that long steps, up to the end of the output, s, missed, or None.

    The steps are checked at their midpoint, and throughout if a force law is a Python function.
    """
    count = int(np.searchsorted(found.begin, end))
    steps = np.arange(count) if found.whole else _doubtful(found, count, settings)
    if not len(steps):
        return None
    if found.whole:
        steps, parts = _all_along(found, steps, settings)
        motion = found.at(steps, parts)
    else:
        motion = found.middles(steps)
    rows = found.dynamics.report(motion.t, motion.q, motion.u, near_constraints(settings))
    return _judged(found, steps, motion, rows, settings)


def _doubtful(found: LongSteps, count: int, settings: RunSettings) -> np.ndarray:
    """Return the few of the first `count` steps that need a full check."""
    system = found.dynamics.system
    atol = found.dynamics.kept("tolerances", settings, lambda: absolute_tolerances(system, settings))
    tolerances = settings.rtol, atol[system.n_q :]
    ends, states = (found.begin[:count], found.end[:count]), (found.q[:count], found.u[:count])
    return found.dynamics.contradicting(
        ends,
        LONG_STEP.from_middle,
        states,
        tolerances,
        (
            RUN_CHECKS.worth_a_note * RUN_CHECKS.overlooked_part,
            RUN_CHECKS.worth_a_note * RUN_CHECKS.contradicted_tolerances,
        ),
    )


def _all_along(found: LongSteps, steps: np.ndarray, settings: RunSettings) -> tuple[np.ndarray, np.ndarray]:
    """Return steps and fractions of them, evenly spaced in time; an odd number in each includes its midpoint."""
    spacing = settings.duration / RUN_CHECKS.parts_of_a_run
    counts = 2 * ((found.end - found.begin)[steps] / (2.0 * spacing)).astype(int) + 1
    first, of_number = (np.repeat(values, counts) for values in (np.cumsum(counts) - counts, counts))
    return np.repeat(steps, counts), (np.arange(len(first)) - first + 0.5) / of_number


def _judged(
    found: LongSteps, steps: np.ndarray, motion: Motion, rows: OutputRows, settings: RunSettings
) -> Overlooked | None:
    system, done = found.dynamics.system, len(rows.t)
    steps, rate = steps[:done], motion.rate[:done]
    off = rows.acceleration - rate
    size = np.fmax(rows.acceleration**2 @ system.mass, rate**2 @ system.mass)
    places = np.flatnonzero(off**2 @ system.mass > RUN_CHECKS.overlooked_part**2 * size)
    if not len(places):
        return None
    length = (found.end - found.begin)[steps]
    tolerance = absolute_tolerances(system, settings)
    of_velocities = tolerance[system.n_q :] + settings.rtol * np.abs(rows.u[places])
    over_step = np.abs(off[places]) * length[places, None] / (RUN_CHECKS.contradicted_tolerances * of_velocities)
    peaks = _peaks(places[(over_step > 1.0).any(axis=1)], steps, size)
    peaks = [k for k in peaks if off[k] ** 2 @ system.mass > _of_errors(found, rows, k, settings) ** 2 @ system.mass]
    if not peaks:
        return None
    first = peaks[0]
    of_first = np.abs(off[first]) / (tolerance[system.n_q :] + settings.rtol * np.abs(rows.u[first]))
    velocity = system.name_of(int(np.nanargmax(of_first)), system.of_body.velocities)
    return Overlooked(rows.t[peaks], float(length[first]), velocity, acting(system, rows, first))


def _peaks(places: np.ndarray, steps: np.ndarray, size: np.ndarray) -> list[int]:
    """Return the place with the largest acceleration of each group of neighbours within one step."""
    ends = np.flatnonzero((np.diff(places) > 1) | (np.diff(steps[places]) > 0)) + 1
    return [int(part[np.argmax(size[part])]) for part in np.split(places, ends) if len(part)]


def _of_errors(found: LongSteps, rows: OutputRows, k: int, settings: RunSettings) -> np.ndarray:
    """Return the change of accelerations at a row by errors far below the tolerance; stiff forces make it large."""
    dynamics, state = found.dynamics, np.concatenate([rows.q[k], rows.u[k]])
    errors = RUN_CHECKS.slight * (absolute_tolerances(dynamics.system, settings) + settings.rtol * np.abs(state))
    states = np.vstack([state, state + np.diag(errors)])
    q, u = np.split(states, [dynamics.system.n_q], axis=1)
    accelerations = dynamics.report(np.full(len(states), rows.t[k]), q, u, False).acceleration
    return np.abs(accelerations[1:] - accelerations[0]).sum(axis=0)

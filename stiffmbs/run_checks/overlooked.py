"""Missed events: forces at output times that contradict the step containing them.

The integrator has a polynomial in each step, and the block system gives accelerations at every output time. Between two
output times in one step, the mean of their accelerations times the interval is the velocity change. For smooth motions
the difference is small, and errors within the tolerance cause a limited number of tolerances. A force that acts within
the step only, and at an output time, exceeds both. So does half a period of a vibration within one step of a high order:
the interval is solved again from its first output time, and only if the velocities at its end differ, an event was missed.
In strong damping, errors of velocities within a step explain large accelerations, which then show no event. Velocities
that joints and drives prescribe follow no force, so that differences in them are left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..compile.reactions import reactions
from ..compile.system import System
from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.storage import blocks, release
from ..model.settings import RunSettings
from ..notes import Note, NoteKind
from ..solve.error_control.tolerances import absolute_tolerances
from ..solve.events.whole_steps import Motion, WholeSteps
from ..solve.settings import near_constraints
from ..solve.trajectory import Trajectory
from .parameters import RUN_CHECKS

MISSED = (
    "a step of {step:.2g} s missed {law} at t = {t:.6g} s{more}: the accelerations of {velocity} there contradict the "
    "solution of the step"
)
"""Text of notes on missed events."""

SolvedAgain = Callable[[int], np.ndarray | None]
"""Solves the interval after an output row again, from the state of this row; returns the velocities at its end or None."""


@dataclass(frozen=True, eq=False)
class Overlooked:
    """Events that the steps of a run missed.

    - `times`: one time for each step with such events, s: that of the largest acceleration in the first contradicting
      pair of output times, or, in steps with Python functions, in the step.
    - `step`: length of the first of these steps, s.
    - `velocity`: velocity that would have changed most there.
    - `element`: force law with the largest force there, or an empty string.
    - `shortest`: duration of the shortest of the contradictions in steps with Python functions, s; infinite for other laws.
    """

    times: np.ndarray
    step: float
    velocity: str
    element: str
    shortest: float = math.inf

    def note(self, kind: NoteKind, max_step: float = 0.0) -> Note:
        """Return a note on the first missed event, whose kind says what was done about it."""
        more = f" and at {len(self.times) - 1} more times" if len(self.times) > 1 else ""
        law = f"'{self.element}'" if self.element else "a force"
        return kind(
            self.element, step=self.step, law=law, t=self.times[0], more=more, velocity=self.velocity, max_step=max_step
        )


def together(found: Sequence[Overlooked]) -> Overlooked | None:
    """Merge several results, described by the earliest; None if there is none."""
    if not found:
        return None
    return replace(
        min(found, key=lambda each: float(each.times[0])),
        times=np.unique(np.concatenate([each.times for each in found])),
        shortest=min(each.shortest for each in found),
    )


def overlooked(
    dynamics: Dynamics, rows: OutputRows, trajectory: Trajectory, settings: RunSettings, again: SolvedAgain
) -> Overlooked | None:
    """Return the events that the steps of a run missed; None if there are none or no force law has breakpoints."""
    system, steps = dynamics.system, trajectory.step_times
    if len(steps) < 2 or not system.has_laws:
        return None
    absolute = absolute_tolerances(system, settings)[system.n_q :]
    least = RUN_CHECKS.overlooked_tolerances * absolute / np.diff(steps).max()
    pairs, off = contradicting_rows(rows, system.mass, steps, least)
    if not len(pairs):
        return None
    number = np.searchsorted(steps, rows.t[pairs])
    step = steps[number] - steps[number - 1]
    tolerance = absolute + settings.rtol * np.abs(rows.u[pairs])
    off = _free_part(dynamics, rows, pairs, off)
    over_step = np.abs(off) * step[:, None] / (RUN_CHECKS.overlooked_tolerances * tolerance)
    found = np.flatnonzero((over_step > 1).any(axis=1))
    if len(found) <= RUN_CHECKS.most_instants:
        found = found[[_ends_elsewhere(rows, int(pairs[k]), tolerance[k], again) for k in found]]
    found = found[
        [not _is_of_damping(dynamics, rows, int(pairs[k]), off[k], over_step[k] > 1, settings) for k in found]
    ]
    if not len(found):
        return None
    _, first = np.unique(number[found], return_index=True)
    first_size, second_size = (rows.acceleration[k] ** 2 @ system.mass for k in (pairs, pairs + 1))
    at, k = (pairs + (second_size > first_size))[found], found[0]
    velocity, peak = system.name_of(int(np.nanargmax(over_step[k])), system.of_body.velocities), int(at[0])
    around = max(peak - 1, 0), min(peak + 1, len(rows.t) - 1)
    return Overlooked(rows.t[at[first]], float(step[k]), velocity, acting(system, rows, peak, around))


def _ends_elsewhere(rows: OutputRows, k: int, tolerance: np.ndarray, again: SolvedAgain) -> bool:
    """Return True if a solution from row `k` on has velocities at the next row that differ by more than the tolerance."""
    found = again(k)
    return found is None or not (np.abs(found - rows.u[k + 1]) <= tolerance).all()


def _is_of_damping(
    dynamics: Dynamics, rows: OutputRows, k: int, off: np.ndarray, large: np.ndarray, settings: RunSettings
) -> bool:
    """Return True if errors of velocities explain the large ones of the accelerations `off` by which row `k` contradicts the next."""
    explained = np.fmax(*(_of_errors(dynamics, rows, row, settings, 0.0) for row in (k, k + 1)))
    return bool((np.abs(off) <= explained)[large].all())


def contradicting_rows(
    rows: OutputRows, mass: np.ndarray, steps: np.ndarray, least: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers of the rows that contradict the next one in the same step, and by which accelerations.

    These are the mean rates of the velocities up to the next row minus the means of their accelerations.

    `mass` of shape (n_u,): weights of accelerations. `steps`: ends of steps, s. `least` of shape (n_u,): differences
    of accelerations up to which there is no contradiction.
    """
    found, ends = [(np.empty(0, dtype=int), np.empty((0, len(mass))))], np.append(steps, -np.inf)
    for block in blocks(len(rows.t) - 1):
        both = slice(block.start, block.stop + 1)
        t, u, acceleration = rows.t[both], rows.u[both], rows.acceleration[both]
        number = np.searchsorted(steps, t[:-1], side="right")
        within = (number > 0) & (ends[number - 1] < t[:-1]) & (t[1:] < ends[number])
        off = np.diff(u, axis=0) * (1.0 / np.diff(t))[:, None] - 0.5 * (acceleration[:-1] + acceleration[1:])
        size = acceleration**2 @ mass
        much = off**2 @ mass > RUN_CHECKS.overlooked_part**2 * np.fmax(size[:-1], size[1:])
        at = np.flatnonzero(within & much & (np.abs(off) > least).any(axis=1))
        found.append((block.start + at, off[at]))
        release(rows.u, rows.acceleration)
    pairs, contradictions = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return pairs, contradictions


def _free_part(dynamics: Dynamics, rows: OutputRows, numbers: np.ndarray, off: np.ndarray) -> np.ndarray:
    """Return the parts of differences of accelerations, one for each of some rows, that no joint or drive prescribes."""
    state, free = dynamics.state, off.copy()
    if not dynamics.system.n_c:
        return free
    with state.unchanged():
        for part, k in zip(free, numbers.tolist(), strict=True):
            prescribed = []
            for u in (part, np.zeros_like(part)):
                state.q[:], state.u[:] = rows.q[k], u
                if dynamics.correct_velocities(float(rows.t[k])) < 0:
                    break
                prescribed.append(state.u.copy())
            else:
                part[:] = prescribed[0] - prescribed[1]
    return free


def acting(system: System, rows: OutputRows, k: int, around: tuple[int, int]) -> str:
    """Return the force law whose force or torque at a row differs most from its mean at two rows around it."""
    laws = {name for group in system.groups if group.has_law for name in group.names}
    found = reactions(system, rows.values[[k, *around]])
    changes = {
        name: abs(float(value[0] - 0.5 * (value[1] + value[2])))
        for name, value in found.items()
        if name.rpartition(".")[0] in laws
    }
    return max(changes, key=lambda name: changes[name], default="").rpartition(".")[0]


def overlooked_in_whole_steps(found: WholeSteps, settings: RunSettings, end: float) -> Overlooked | None:
    """Return the events that steps with Python functions, up to the end of the output, s, missed, or None."""
    if not (count := int(np.searchsorted(found.begin, end))):
        return None
    steps, parts = _all_along(found, np.arange(count), settings)
    motion = found.at(steps, parts)
    rows = found.dynamics.report(motion.t, motion.q, motion.u, near_constraints(settings))
    return _judged(found, steps, motion, rows, settings)


def unchecked_from(found: WholeSteps, trajectory: Trajectory, settings: RunSettings) -> float:
    """Return the time from which on steps longer than the spacing of samples were not stored, s; infinite if none."""
    if not found.full:
        return math.inf
    later = trajectory.step_times[trajectory.step_times >= found.end[-1]]
    return float(found.end[-1]) if np.diff(later).max(initial=0.0) > _spacing(settings) else math.inf


def _all_along(found: WholeSteps, steps: np.ndarray, settings: RunSettings) -> tuple[np.ndarray, np.ndarray]:
    """Return steps and fractions of them, evenly spaced in time; an odd number in each includes its midpoint."""
    counts = 2 * ((found.end - found.begin)[steps] / (2.0 * _spacing(settings))).astype(int) + 1
    first, of_number = (np.repeat(values, counts) for values in (np.cumsum(counts) - counts, counts))
    return np.repeat(steps, counts), (np.arange(len(first)) - first + 0.5) / of_number


def _judged(
    found: WholeSteps, steps: np.ndarray, motion: Motion, rows: OutputRows, settings: RunSettings
) -> Overlooked | None:
    system, done = found.dynamics.system, len(rows.t)
    steps, rate = steps[:done], motion.rate[:done]
    off = rows.acceleration - rate
    # each velocity by itself: a large acceleration of another body does not hide it
    least = RUN_CHECKS.overlooked_part * np.fmax(np.abs(rows.acceleration), np.abs(rate))
    length = (found.end - found.begin)[steps]
    tolerance = absolute_tolerances(system, settings)[system.n_q :] + settings.rtol * np.abs(rows.u)
    least = np.fmax(least, RUN_CHECKS.contradicted_tolerances * tolerance / length[:, None])
    places = np.flatnonzero((np.abs(off) > least).any(axis=1))
    off[places] = _free_part(found.dynamics, rows, places, off[places])
    places = places[(np.abs(off[places]) > least[places]).any(axis=1)]
    groups = [(group, _centre(group, off[group] ** 2 @ system.mass)) for group in _neighbours(places, steps)]
    groups = [
        (group, k)
        for group, k in groups
        if (np.abs(off[k]) > np.fmax(least[k], _of_errors(found.dynamics, rows, k, settings, RUN_CHECKS.slight))).any()
    ]
    if not groups:
        return None
    (group, first), peaks = groups[0], [k for _, k in groups]
    of_first = np.where(np.abs(off[first]) > least[first], np.abs(off[first]) / tolerance[first], 0.0)
    velocity = system.name_of(int(np.argmax(of_first)), system.of_body.velocities)
    around = max(group[0] - 1, 0), min(group[-1] + 1, done - 1)
    reach = np.array([max(k - group[0], group[-1] - k) + 1 for group, k in groups]) * _spacing(settings)
    shortest = _shortest(found, steps[peaks], rows.t[peaks], reach, settings)
    return Overlooked(rows.t[peaks], float(length[first]), velocity, acting(system, rows, first, around), shortest)


def _spacing(settings: RunSettings) -> float:
    return settings.duration / RUN_CHECKS.parts_of_a_run


def _shortest(
    found: WholeSteps, steps: np.ndarray, times: np.ndarray, reach: np.ndarray, settings: RunSettings
) -> float:
    """Return the duration of the shortest of the contradictions around some times, s, at half of their height.

    `reach`: time before and after each within which it is sampled, s.
    """
    parts = np.linspace(-1.0, 1.0, RUN_CHECKS.parts_of_a_peak)
    length = (found.end - found.begin)[steps]
    middle = (times - found.begin[steps]) / length
    places = np.clip(middle[:, None] + (reach / length)[:, None] * parts, 0.0, 1.0)
    motion = found.at(np.repeat(steps, len(parts)), places.ravel())
    rows = found.dynamics.report(motion.t, motion.q, motion.u, near_constraints(settings))
    off = (rows.acceleration - motion.rate[: len(rows.t)]) ** 2 @ found.dynamics.system.mass
    off = np.resize(off, places.shape)
    high = _high(off).sum(axis=1)
    return float((high * reach).min() * 2.0 / len(parts))


def _centre(group: np.ndarray, squares: np.ndarray) -> int:
    """Return the middle one of the places at which a contradiction, with given squares of its height, is high.

    The largest one of a force that is constant within an interval may be at its edge, where any error changes the force.
    """
    high = group[_high(squares)]
    return int(high[len(high) // 2])


def _high(squares: np.ndarray) -> np.ndarray:
    """Return a mask of the values, along the last axis, that are at least half of the largest; squares are given."""
    return np.asarray(squares >= 0.25 * squares.max(axis=-1, keepdims=True))


def _neighbours(places: np.ndarray, steps: np.ndarray) -> list[np.ndarray]:
    """Return the groups of successive places within one step."""
    ends = np.flatnonzero((np.diff(places) > 1) | (np.diff(steps[places]) > 0)) + 1
    return np.split(places, ends) if len(places) else []


def _of_errors(dynamics: Dynamics, rows: OutputRows, k: int, settings: RunSettings, of_positions: float) -> np.ndarray:
    """Return the change of accelerations at a row by errors that a step may have; stiff forces make it large.

    `of_positions`: errors of positions, in tolerances.
    """
    state = np.concatenate([rows.q[k], rows.u[k]])
    slight = np.repeat([of_positions, RUN_CHECKS.slight_velocity], [rows.q.shape[1], rows.u.shape[1]])
    errors = slight * (absolute_tolerances(dynamics.system, settings) + settings.rtol * np.abs(state))
    states = np.vstack([state, state + np.diag(errors)[errors > 0.0]])
    q, u = np.split(states, [dynamics.system.n_q], axis=1)
    accelerations = dynamics.report(np.full(len(states), rows.t[k]), q, u, False).acceleration
    return np.asarray(np.abs(accelerations[1:] - accelerations[0]).sum(axis=0))
